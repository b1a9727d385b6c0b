"""Registers and digital outputs of a controller in memory."""

# ruff: noqa: D102 - a method do_NAME is the instruction NAME of the script manual

from __future__ import annotations

from .errors import Fault
from .values import Value, kind, spoken

SIZES = {"float": 48, "integer": 48, "boolean": 128}
EMPTY: dict[str, Value] = {"float": 0.0, "integer": 0, "boolean": False}
OUTPUTS = {"standard": 8, "configurable": 8, "tool": 2, "flag": 32}


class Registers:
    """General purpose registers 0..47 (booleans 0..127) and digital outputs.

    Attributes:
        inputs: (kind, address) to value, kind being float, integer or boolean; what a client wrote.
        outputs: the same for what the program wrote.
        digital: (group, number) to value, group being standard, configurable, tool or flag.
        unset_is_error: reading a register that nobody wrote stops the program. The controller gives zero;
            this finds programs that rely on it.

    """

    def __init__(self) -> None:
        self.inputs: dict[tuple[str, int], Value] = {}
        self.outputs: dict[tuple[str, int], Value] = {}
        self.digital: dict[tuple[str, int], bool] = {}
        self.unset_is_error = False

    def _read(self, table: dict[tuple[str, int], Value], sort: str, address: Value) -> Value:
        key = sort, _number(address, SIZES[sort], f"{sort} register")
        if key not in table and self.unset_is_error:
            raise Fault(f"{sort} register {address} was never written", "unset-register")
        return table.get(key, EMPTY[sort])

    def _write(self, sort: str, address: Value, value: Value) -> None:
        number = _number(address, SIZES[sort], f"{sort} register")
        if kind(value) != sort and (sort, kind(value)) != ("float", "integer"):
            raise Fault(f"a {sort} register does not take {spoken(value)}", "type")
        self.outputs[sort, number] = float(value) if sort == "float" else value  # type: ignore[arg-type]

    def do_read_input_float_register(self, address: Value) -> Value:
        return self._read(self.inputs, "float", address)

    def do_read_input_integer_register(self, address: Value) -> Value:
        return self._read(self.inputs, "integer", address)

    def do_read_input_boolean_register(self, address: Value) -> Value:
        return self._read(self.inputs, "boolean", address)

    def do_read_output_float_register(self, address: Value) -> Value:
        return self._read(self.outputs, "float", address)

    def do_read_output_integer_register(self, address: Value) -> Value:
        return self._read(self.outputs, "integer", address)

    def do_read_output_boolean_register(self, address: Value) -> Value:
        return self._read(self.outputs, "boolean", address)

    def do_write_output_float_register(self, address: Value, value: Value) -> None:
        self._write("float", address, value)

    def do_write_output_integer_register(self, address: Value, value: Value) -> None:
        self._write("integer", address, value)

    def do_write_output_boolean_register(self, address: Value, value: Value) -> None:
        self._write("boolean", address, value)

    def _set(self, group: str, n: Value, b: Value) -> None:
        if not isinstance(b, bool):
            raise Fault(f"a digital output takes True or False, not {spoken(b)}", "type")
        self.digital[group, _number(n, OUTPUTS[group], f"{group} output")] = b

    def _get(self, group: str, n: Value) -> bool:
        return self.digital.get((group, _number(n, OUTPUTS[group], f"{group} output")), False)

    def do_set_standard_digital_out(self, n: Value, b: Value) -> None:
        self._set("standard", n, b)

    def do_set_configurable_digital_out(self, n: Value, b: Value) -> None:
        self._set("configurable", n, b)

    def do_set_tool_digital_out(self, n: Value, b: Value) -> None:
        self._set("tool", n, b)

    def do_set_flag(self, n: Value, b: Value) -> None:
        self._set("flag", n, b)

    def do_get_standard_digital_out(self, n: Value) -> bool:
        return self._get("standard", n)

    def do_get_configurable_digital_out(self, n: Value) -> bool:
        return self._get("configurable", n)

    def do_get_tool_digital_out(self, n: Value) -> bool:
        return self._get("tool", n)

    def do_get_flag(self, n: Value) -> bool:
        return self._get("flag", n)


def _number(value: Value, size: int, what: str) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value < size:
        raise Fault(f"{what} {value!r} is not one of 0 to {size - 1}", "address")
    return value
