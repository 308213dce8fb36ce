"""What the code of a function may consist of: everything that is not named here is refused.

The names are allowed wherever they stand and whatever value they are read from, so each list holds
only what is harmless on every value that allowed code can get hold of.
"""

import ast

LONGEST_SOURCE = 10_000
"""Characters."""

LONGEST_NAME = 100
"""Characters of an identifier."""

MOST_NODES = 4_000
"""Nodes of the syntax tree."""

DEEPEST_TREE = 50
"""Levels of the syntax tree; a sum of n terms has about n of them."""

DEEPEST_BRACKETS = 30
"""Brackets within brackets."""

LARGEST_INTEGER = 2**64
"""Integers that are written out are smaller; what is calculated is limited by time and memory."""

NODES: frozenset[type[ast.AST]] = frozenset(
    {
        *(ast.Module, ast.FunctionDef, ast.Lambda, ast.arguments, ast.arg, ast.Return),
        *(ast.Yield, ast.YieldFrom),
        *(ast.Assign, ast.AugAssign, ast.NamedExpr, ast.Expr, ast.Pass, ast.Assert),
        *(ast.If, ast.For, ast.While, ast.Break, ast.Continue),
        *(ast.Try, ast.ExceptHandler, ast.Raise),
        *(ast.Name, ast.Load, ast.Store, ast.Constant, ast.JoinedStr, ast.FormattedValue),
        *(ast.Attribute, ast.Subscript, ast.Slice, ast.Starred, ast.Call, ast.keyword),
        *(ast.Tuple, ast.List, ast.Dict, ast.Set),
        *(ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp, ast.comprehension),
        *(ast.IfExp, ast.BoolOp, ast.And, ast.Or, ast.Compare, ast.UnaryOp, ast.BinOp),
        *(ast.Not, ast.UAdd, ast.USub, ast.Invert),
        *(ast.Add, ast.Sub, ast.Mult, ast.Div, ast.FloorDiv, ast.Mod, ast.Pow, ast.MatMult),
        *(ast.BitAnd, ast.BitOr, ast.BitXor, ast.LShift, ast.RShift),
        *(ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Is, ast.IsNot, ast.In),
        ast.NotIn,
    }
)
"""The kinds of syntax. Classes, `with`, `del`, `global`, `match` and `async` are not among them."""

EXCEPTIONS = (
    *("ArithmeticError", "AssertionError", "AttributeError", "Exception", "FloatingPointError"),
    *("IndexError", "KeyError", "LookupError", "NameError", "NotImplementedError"),
    *("OverflowError", "RuntimeError", "StopIteration", "TypeError", "ValueError"),
    "ZeroDivisionError",
)
"""The exceptions that calculations meet; none that stands for a limit of the sandbox."""

BUILTINS = (
    *("abs", "all", "any", "bool", "callable", "complex", "dict", "divmod", "enumerate", "filter"),
    *("float", "frozenset", "int", "isinstance", "iter", "len", "list", "map", "max", "min"),
    *("next", "pow", "range", "reversed", "round", "set", "slice", "sorted", "str", "sum"),
    *("tuple", "zip"),
    *EXCEPTIONS,
)
"""Pure ones. `print`, `type`, `getattr`, `hash`, `id`, `repr` and `format` are not among them."""

MATH_NAMES = (
    *("acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "ceil", "copysign"),
    *("cos", "cosh", "degrees", "dist", "e", "erf", "erfc", "exp", "exp2", "expm1", "fabs"),
    *("floor", "fmod", "frexp", "fsum", "gamma", "gcd", "hypot", "inf", "isclose", "isfinite"),
    *("isinf", "isnan", "ldexp", "lgamma", "log", "log10", "log1p", "log2", "modf", "nan"),
    *("nextafter", "pi", "pow", "prod", "radians", "remainder", "sin", "sinh", "sqrt", "tan"),
    *("tanh", "tau", "trunc"),
)
"""What `math` has, but for what counts (`comb`, `factorial`, `isqrt`, `lcm`, `perm`), and `ulp`."""

NUMPY_CREATORS = (
    *("arange", "array", "asarray", "empty", "eye", "full", "full_like", "fromiter", "identity"),
    *("linspace", "logspace", "ones", "ones_like", "zeros", "zeros_like"),
)
"""The functions of `np` that make arrays from anything; theirs hold numbers and nothing else."""

NUMPY_SHAPERS = (
    *("append", "array_split", "atleast_1d", "atleast_2d", "atleast_3d", "broadcast_to"),
    *("column_stack", "concatenate", "delete", "dstack", "expand_dims", "flip", "fliplr"),
    *("flipud", "hstack", "insert", "kron", "meshgrid", "moveaxis", "pad", "ravel", "repeat"),
    *("reshape", "roll", "rot90", "select", "split", "squeeze", "stack", "swapaxes", "take"),
    *("tile", "transpose", "vstack", "where"),
)
"""Those that put what they are given into another shape; the same holds for them."""

NUMPY_TYPES = (
    *("bool", "bool_", "float32", "float64", "floating", "generic", "int32", "int64", "int_"),
    *("integer", "number"),
)
"""Types of numbers, to convert to and to compare with."""

NUMPY_NAMES = (
    *("e", "inf", "linalg", "nan", "newaxis", "pi"),
    *NUMPY_CREATORS,
    *NUMPY_TYPES,
    # Of each element.
    *("abs", "absolute", "add", "angle", "arccos", "arccosh", "arcsin", "arcsinh", "arctan"),
    *("arctan2", "arctanh", "around", "bitwise_and", "bitwise_or", "bitwise_xor", "cbrt", "ceil"),
    *("clip", "conj", "copysign", "cos", "cosh", "deg2rad", "degrees", "divide", "divmod"),
    *("equal", "exp", "exp2", "expm1", "fabs", "float_power", "floor", "floor_divide", "fmax"),
    *("fmin", "fmod", "greater", "greater_equal", "heaviside", "hypot", "imag", "isclose"),
    *("isfinite", "isin", "isinf", "isnan", "less", "less_equal", "log", "log10", "log1p", "log2"),
    *("logaddexp", "logical_and", "logical_not", "logical_or", "logical_xor", "maximum"),
    *("minimum", "mod", "multiply", "nan_to_num", "negative", "not_equal", "power", "rad2deg"),
    *("radians", "real", "reciprocal", "remainder", "rint", "round", "sign", "signbit", "sin"),
    *("sinc", "sinh", "sqrt", "square", "subtract", "tan", "tanh", "trunc", "unwrap"),
    # Of all elements, or along an axis.
    *("all", "allclose", "amax", "amin", "any", "argmax", "argmin", "argpartition", "argsort"),
    *("argwhere", "array_equal", "average", "bincount", "corrcoef", "count_nonzero", "cov"),
    *("cumprod", "cumsum", "diff", "ediff1d", "flatnonzero", "gradient", "intersect1d"),
    *("isscalar", "lexsort", "max", "mean", "median", "min", "nanargmax", "nanargmin"),
    *("nancumsum", "nanmax", "nanmean", "nanmedian", "nanmin", "nanpercentile", "nanprod"),
    *("nanquantile", "nanstd", "nansum", "nanvar", "ndim", "nonzero", "partition", "percentile"),
    *("prod", "ptp", "quantile", "searchsorted", "setdiff1d", "shape", "size", "sort", "std"),
    *("sum", "trapezoid", "union1d", "unique", "var"),
    # Of vectors, matrices and curves.
    *("convolve", "correlate", "cross", "diag", "diagonal", "digitize", "dot", "einsum"),
    *("histogram", "inner", "interp", "matmul", "outer", "polyfit", "polyval", "roots"),
    *("tensordot", "trace", "tril", "triu", "vdot"),
    *NUMPY_SHAPERS,
)
"""What `np` has: nothing that reads or writes files, draws at random or compiles."""

LINALG_NAMES = (
    *("LinAlgError", "cond", "cross", "det", "eig", "eigh", "eigvals", "eigvalsh", "inv", "lstsq"),
    *("matrix_norm", "matrix_power", "matrix_rank", "norm", "outer", "pinv", "qr", "solve", "svd"),
    *("svdvals", "trace", "vector_norm"),
)
"""What `np.linalg` has."""

MUTATORS = frozenset(
    {
        *("add", "append", "clear", "discard", "extend", "fill", "insert", "pop", "popitem"),
        *("remove", "reverse", "setdefault", "sort", "update"),
    }
)
"""Methods that change the value they are called on: a function's own values, never its globals."""

VALUE_ATTRIBUTES = frozenset(
    {
        *MUTATORS,
        # str: none whose argument is a width, a template or an encoding.
        *("capitalize", "casefold", "endswith", "find", "isalnum", "isalpha", "isdigit"),
        *("islower", "isnumeric", "isspace", "isupper", "join", "lower", "lstrip", "partition"),
        *("removeprefix", "removesuffix", "replace", "rfind", "rindex", "rpartition", "rsplit"),
        *("rstrip", "split", "splitlines", "startswith", "strip", "swapcase", "title", "upper"),
        # Sequences, mappings and sets.
        *("copy", "count", "difference", "fromkeys", "get", "index", "intersection"),
        *("isdisjoint", "issubset", "issuperset", "items", "keys", "symmetric_difference"),
        *("union", "values"),
        # Numbers.
        *("as_integer_ratio", "bit_length", "conj", "conjugate", "imag", "is_integer", "real"),
        # Slices and ranges.
        *("indices", "start", "step", "stop"),
        # Arrays and ufuncs: nothing that writes files or reinterprets memory.
        *("T", "accumulate", "all", "any", "argmax", "argmin", "argsort", "astype", "clip"),
        *("cumprod", "cumsum", "diagonal", "dot", "flatten", "item", "max", "mean", "min"),
        *("ndim", "nonzero", "outer", "prod", "ravel", "reduce", "repeat", "reshape", "round"),
        *("searchsorted", "shape", "size", "squeeze", "std", "sum", "swapaxes", "take"),
        *("tolist", "trace", "transpose", "var"),
    }
)
"""Attributes that may be read from any value."""

FACADE_NAMES = {"math": MATH_NAMES, "np": NUMPY_NAMES, "np.linalg": LINALG_NAMES}
"""What may be read from the facades that stand for modules."""

IMPORTS = {"math": "math", "numpy": "np", "numpy.linalg": "np.linalg"}
"""The facade for each module whose import is replaced, as it stands in the code that runs."""

ANNOTATION_MODULES = frozenset({"__future__", "typing", "typing_extensions", "collections.abc"})
"""Modules that only annotations need; importing them is left out with the annotations."""

SELECTING = frozenset(
    {
        *("all", "amax", "amin", "any", "max", "mean", "min", "nanmax", "nanmean", "nanmin"),
        *("nanprod", "nanstd", "nansum", "nanvar", "prod", "reduce", "std", "sum", "var"),
    }
)
"""What may be told `where` to look; anything else would leave memory as it was elsewhere."""

TYPE_PLACES = {
    **dict.fromkeys(("cumprod", "cumsum", "mean", "prod", "std", "sum", "var"), 1),
    **dict.fromkeys(("nancumsum", "nanmean", "nanprod", "nanstd", "nansum", "nanvar"), 1),
    "trace": 3,
}
"""Which argument of an array's method is the type of the elements; of a function, the next."""

DTYPES = frozenset({"bool", "complex", "float", "int"})
"""Builtins that say what the elements of an array are."""

DTYPE_TEXTS = frozenset(
    {*DTYPES, "bool_", "float32", "float64", "int32", "int64", "f4", "f8", "i4", "i8"}
)
"""The same as text."""
