"""From SymPy's straight-line definitions to CasADi scalars.

CasADi folds constants, zeros and equal subexpressions while the graph is built, and differentiates
where one derived quantity follows from another (mass matrix from momentum, and so on).
"""

from collections.abc import Mapping

import casadi as ca
import sympy as sp

from ..symbolic.chain import Chain

Environment = dict[sp.Symbol, ca.SX]

_FUNCTIONS = {sp.cos: ca.cos, sp.sin: ca.sin, sp.exp: ca.exp, sp.Abs: ca.fabs}


def symbols(names: tuple[sp.Symbol, ...]) -> ca.SX:
    """Return a column of CasADi symbols with these names."""
    return ca.vertcat(*(ca.SX.sym(x.name) for x in names))


def numbers(values: Mapping[sp.Symbol, sp.Expr | float]) -> Environment:
    """Return constants for symbols."""
    return {symbol: ca.SX(float(value)) for symbol, value in values.items()}


def convert_chain(chain: Chain, environment: Environment) -> Environment:
    """Return the environment with a scalar for every definition of the chain added."""
    grown = dict(environment)
    for symbol, definition in chain:
        grown[symbol] = convert(definition, grown)
    return grown


def convert(expression: sp.Expr, environment: Environment) -> ca.SX:
    """Return the CasADi scalar of an expression whose symbols all stand in the environment.

    Sums begin with a term that has no minus sign, and products multiply what is constant first, so
    that negations and constants cost nothing.
    """
    if expression.is_Symbol:
        return environment[expression]
    if expression.is_Number or expression.is_NumberSymbol:
        return ca.SX(float(expression))
    if expression.is_Add:
        return _sum(expression, environment)
    if expression.is_Mul:
        return _product(expression, environment)
    if expression.is_Pow:
        return _power(expression, environment)
    return _FUNCTIONS[expression.func](convert(expression.args[0], environment))


def _sum(expression: sp.Expr, environment: Environment) -> ca.SX:
    terms = sorted(expression.args, key=lambda t: t.could_extract_minus_sign())
    total = convert(terms[0], environment)
    for term in terms[1:]:
        if term.could_extract_minus_sign():
            total = total - convert(-term, environment)
        else:
            total = total + convert(term, environment)
    return total


def _product(expression: sp.Expr, environment: Environment) -> ca.SX:
    if expression.could_extract_minus_sign():
        return -convert(-expression, environment)
    factors = [convert(x, environment) for x in expression.args]
    factors.sort(key=lambda x: not x.is_constant())
    total = factors[0]
    for factor in factors[1:]:
        total = total * factor
    return total


def _power(expression: sp.Expr, environment: Environment) -> ca.SX:
    base = convert(expression.base, environment)
    exponent = expression.exp
    if exponent == 2:
        return base * base
    if exponent == 3:
        return base * base * base
    if exponent == -1:
        return 1 / base
    return base ** convert(exponent, environment)
