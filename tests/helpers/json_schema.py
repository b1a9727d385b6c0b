"""As much of JSON Schema 2020-12 as the findings' schema uses; an unknown keyword is an error, not a pass."""

from typing import Any

_TYPES = {
    "object": dict, "array": list, "string": str, "number": (int, float), "integer": int, "null": type(None),
}  # fmt: skip
_KNOWN = {
    "$schema", "$defs", "$ref", "title", "type", "required", "properties", "additionalProperties", "items",
    "prefixItems", "minItems", "uniqueItems", "enum", "const", "minimum", "maximum",
}  # fmt: skip


def problems(
    value: Any, schema: dict[str, Any], root: dict[str, Any] | None = None, at: str = "$"
) -> list[str]:
    """Return what is wrong, each with its path."""
    root = root or schema
    if unknown := set(schema) - _KNOWN:
        raise NotImplementedError(f"keywords {unknown}")
    if "$ref" in schema:
        target: Any = root
        for part in schema["$ref"].removeprefix("#/").split("/"):
            target = target[part]
        return problems(value, target, root, at)
    found = _simple(value, schema, at)
    if isinstance(value, dict):
        found += [f"{at}: {n} is missing" for n in schema.get("required", ()) if n not in value]
        for name, item in value.items():
            inner = schema.get("properties", {}).get(name, schema.get("additionalProperties"))
            if inner:
                found += problems(item, inner, root, f"{at}.{name}")
    if isinstance(value, list):
        inner = [*schema.get("prefixItems", ())]
        rest = schema.get("items")
        for k, item in enumerate(value):
            if k < len(inner) or rest:
                found += problems(item, inner[k] if k < len(inner) else rest, root, f"{at}[{k}]")
    return found


def _simple(value: Any, schema: dict[str, Any], at: str) -> list[str]:
    found = []
    if "type" in schema:
        names = [schema["type"]] if isinstance(schema["type"], str) else schema["type"]
        if isinstance(value, bool) or not any(isinstance(value, _TYPES[n]) for n in names):
            return [f"{at}: {value!r} is no {' or '.join(names)}"]
    if "enum" in schema and value not in schema["enum"]:
        found.append(f"{at}: {value!r} is not one of the names")
    if "const" in schema and value != schema["const"]:
        found.append(f"{at}: {value!r} is not {schema['const']!r}")
    if isinstance(value, int | float):
        if value < schema.get("minimum", value) or value > schema.get("maximum", value):
            found.append(f"{at}: {value} is out of range")
        if value != value or value in (float("inf"), float("-inf")):
            found.append(f"{at}: {value} is no number")
    if isinstance(value, list):
        if len(value) < schema.get("minItems", 0):
            found.append(f"{at}: too short")
        if schema.get("uniqueItems") and len({str(x) for x in value}) < len(value):
            found.append(f"{at}: repeats itself")
    return found
