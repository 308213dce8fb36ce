"""What NumPy loads only when it is first needed is there although no file can be opened."""

import math

import numpy as np

from lqd_llm.sandbox.roles import Role
from lqd_llm.sandbox.sandbox import Sandbox

A, M = "np.array([3.0, 1.0, 2.0, 5.0])", "np.array([[2.0, 1.0], [1.0, 3.0]])"
EXPRESSIONS = (
    *(f"np.{name}({A})" for name in ("median", "mean", "std", "var", "ptp", "nanmedian", "prod")),
    *(f"np.{name}({A})" for name in ("argmax", "nanmax", "nanstd", "cov", "count_nonzero")),
    *(f"np.{name}({A}, 30)" for name in ("percentile",)),
    *(f"np.{name}({A}).sum()" for name in ("diff", "gradient", "unwrap", "unique", "sort")),
    *(f"np.{name}({A}).sum()" for name in ("cumsum", "nan_to_num", "flip", "diag", "argwhere")),
    f"np.quantile({A}, 0.3)",
    f"np.average({A}, weights={A})",
    f"np.polyval(np.polyfit({A}, {A}, 1), 2.0)",
    f"np.histogram({A})[0].sum()",
    f"np.histogram({A}, bins='auto')[1].sum()",
    f"np.einsum('i,i->', {A}, {A})",
    f"np.interp(1.5, [1.0, 2.0], {A}[:2])",
    f"np.corrcoef({A}, np.flip({A}))[0, 1]",
    f"np.trapezoid({A})",
    f"np.kron({M}, {M}).sum()",
    f"np.convolve({A}, {A}).sum()",
    f"np.correlate({A}, {A})[0]",
    f"np.select([{A} > 2], [{A}]).sum()",
    f"np.cross({A}[:3], {A}[1:]).sum()",
    f"np.tensordot({M}, {M})",
    f"np.meshgrid({A}, {A})[0].sum()",
    f"np.insert(np.delete({A}, 0), 1, 7.0).sum()",
    f"np.searchsorted(np.sort({A}), 2.5)",
    f"np.digitize(2.5, np.sort({A}))",
    "np.linspace(0, 1, 7).sum() + np.arange(5).sum()",
    f"np.clip({A}, 1.5, 2.5).sum()",
    *(f"np.{name}({A}).sum()" for name in ("angle", "ediff1d", "nancumsum", "nanprod", "conj")),
    *(f"np.{name}({A}, 1)[0]" for name in ("partition", "argpartition", "pad")),
    *(f"np.{name}({M})[0, 0]" for name in ("flipud", "fliplr", "rot90")),
    *(f"np.{name}({A}, 0.3)" for name in ("nanquantile", "nanpercentile")),
    *(f"len(np.{name}({A}, [1.0, 9.0]))" for name in ("isin", "union1d", "setdiff1d")),
    f"len(np.intersect1d({A}, [1.0, 9.0])) + np.lexsort(({A}, {A}))[0]",
    "np.roots([1.0, -3.0, 2.0])[0] + np.bincount([1, 1, 2])[1] + np.logaddexp(1.0, 2.0)",
    f"np.dstack([{A}, {A}]).sum() + np.atleast_3d({A}).sum() + np.array_split({A}, 3)[0].sum()",
    "np.logspace(0, 2, 3).sum() + np.float_power(2, 0.5)",
    "float(np.bitwise_and(6, 3) + np.bitwise_or(6, 3) + np.bitwise_xor(6, 3)) + np.imag(1j)",
    f"{A}.astype(int).sum() + {A}.round().max() + {A}.any() + {A}.std()",
    f"len(f'{{{A}}}')",
    f"len(str({M}))",
    *(f"np.linalg.{name}({M})" for name in ("det", "norm", "cond", "matrix_rank")),
    *(f"np.linalg.{name}({M}).sum()" for name in ("inv", "pinv", "eigvalsh", "svdvals")),
    f"np.linalg.eigh({M})[0].sum()",
    f"np.linalg.eig({M})[0].sum().real",
    f"np.linalg.svd({M})[1].sum()",
    f"np.linalg.qr({M})[1].sum()",
    f"np.linalg.solve({M}, np.ones(2)).sum()",
    f"np.linalg.lstsq({M}, np.ones(2), rcond=None)[0].sum()",
    f"np.linalg.matrix_power({M}, 3).sum()",
    "math.gamma(3.5) + math.dist((0, 0), (3, 4)) + math.fsum([0.1] * 10)",
    "int('9' * 4000) % 97",
    "len(str(3 ** 8000))",
    "round(2.675, 2) + float('1e-3') + len('ä'.upper())",
)


def test_the_same_numbers_as_outside(function, mugs, layout):
    functions = [
        function(Role.FITNESS, f"return float({expression})", name=expression)
        for expression in EXPRESSIONS
    ]
    with Sandbox(layout, functions=functions) as sandbox:
        results = sandbox.run(mugs.rows(np.arange(1)).arrays())
    assert [(refused.name, refused.reason) for refused in results.refusals] == []
    assert results.dropped == ()
    for expression in EXPRESSIONS:
        value = float(eval(expression, {"np": np, "math": math}))
        # The mean of 76 equal numbers, each rounded exactly once, is that number.
        assert results.fitness[expression][0] == math.fsum([value] * 76) / 76, expression
