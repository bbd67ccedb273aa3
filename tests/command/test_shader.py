# SPDX-License-Identifier: Apache-2.0
"""Random programs of pixel shaders, run by anamorph-machine and by an interpreter of our own here, in exact fractions that are
rounded to each number format after every operation: they must agree to the bit."""
import os
import random
import struct
import subprocess
import unittest
from decimal import Context, Decimal
from fractions import Fraction
from math import isqrt

PROGRAM = os.environ["ANAMORPH_MACHINE"]
PROGRAMS = int(os.environ.get("ANAMORPH_SHADER_PROGRAMS", "40"))
SEED = 1
LETTERS = "xyzw"
DECIMAL = Context(prec=60, Emax=10 ** 6, Emin=-10 ** 6)
# D3DSINCOSCONST1 and 2, in c6 and c7
SINCOS = [["-1.5500992e-6", "-2.1701389e-5", "0.0026041667", "0.00026041668"], ["-0.020833334", "-0.125", "1", "0.5"]]
MATRICES = {"m3x2": (3, 2), "m3x3": (3, 3), "m3x4": (3, 4), "m4x3": (4, 3), "m4x4": (4, 4)}


class NotFinite(Exception):
    """Infinity or a number that is none: left out."""


def whole(x):
    """The nearest whole number, ties to even."""
    below = x.numerator // x.denominator
    rest = x - below
    return below + (rest > Fraction(1, 2) or (rest == Fraction(1, 2) and below % 2 == 1))


def floating(exponent, fraction, subnormals):
    bias = (1 << (exponent - 1)) - 1

    def rounded(x):
        if x == 0:
            return Fraction(0)
        size = abs(x)
        binade = size.numerator.bit_length() - size.denominator.bit_length()
        while Fraction(2) ** binade > size:
            binade -= 1
        place = Fraction(2) ** (max(binade, 1 - bias) - fraction)
        value = whole(x / place) * place
        if abs(value) >= Fraction(2) ** (bias + 1):
            raise NotFinite
        return value if subnormals or abs(value) >= Fraction(2) ** (1 - bias) else Fraction(0)
    return rounded


def fixed(bits, fraction):
    half = 1 << (bits - 1)
    return lambda x: Fraction(max(-half, min(half - 1, whole(x * 2 ** fraction))), 2 ** fraction)


FORMATS = {"float16": floating(5, 10, True), "float24": floating(7, 16, False), "float32": floating(8, 23, True),
           "fixed16": fixed(16, 12), "fixed32": fixed(32, 16)}


LARGEST = {"float16": Fraction(65504), "float24": Fraction(2 - Fraction(1, 2 ** 16)) * 2 ** 63,
           "float32": Fraction(2 - Fraction(1, 2 ** 23)) * 2 ** 127,
           "fixed16": Fraction(2 ** 15 - 1, 2 ** 12), "fixed32": Fraction(2 ** 31 - 1, 2 ** 16)}


def exponential(x):
    """2^x, so near that it rounds alike."""
    if abs(x) > 2000:
        return Fraction(2) ** 2000 if x > 0 else Fraction(0)
    below = x.numerator // x.denominator
    rest = x - below
    power = DECIMAL.power(Decimal(2), DECIMAL.divide(Decimal(rest.numerator), Decimal(rest.denominator)))
    return Fraction(power) * Fraction(2) ** below


def logarithm(x):
    """log2 x, so near that it rounds alike."""
    decimal = DECIMAL.divide(Decimal(x.numerator), Decimal(x.denominator))
    return Fraction(DECIMAL.divide(DECIMAL.ln(decimal), DECIMAL.ln(Decimal(2))))


def root(x):
    """So near the root that it rounds alike."""
    scale = 4 ** 200
    value = Fraction(isqrt(int(x * scale)), 2 ** 200)
    return value if value * value == x else value + Fraction(1, 2 ** 202)


def inverse(x, rounded, name):
    if x != 0:
        return rounded(1 / x)
    if name.startswith("float"):
        raise NotFinite
    return rounded(Fraction(10 ** 9))


class Writer:
    """Makes programs that read nothing before it is written."""

    def __init__(self, chance):
        self.chance = chance
        self.written = {}

    def source(self, read, single, constants, plain=False, but=None):
        while True:
            bank = self.chance.choice("rrct")
            swizzle = self.chance.choice(LETTERS if single else ("xyzw", "yzxw", "zxyw", "wzyx") + tuple(LETTERS))
            if plain:
                swizzle = "xyzw"
            components = swizzle * 4 if len(swizzle) == 1 else swizzle
            needed = {components[i] for i in range(4) if read >> i & 1}
            numbers = {"r": [n for n, has in self.written.items() if needed <= has and n != but], "t": [0],
                       "c": [n for n in range(6) if len(constants | {n}) <= 2]}[bank]
            if numbers:
                number = self.chance.choice(numbers)
                if bank == "c":
                    constants.add(number)
                return "%s%s%d.%s" % (self.chance.choice(["", "", "-"]), bank, number, swizzle)

    def instruction(self):
        name, count = self.chance.choice([
            ("mov", 1), ("add", 2), ("sub", 2), ("mul", 2), ("mad", 3), ("lrp", 3), ("abs", 1), ("frc", 1), ("dp2add", 3),
            ("dp3", 2), ("dp4", 2), ("crs", 2), ("nrm", 1), ("rcp", 1), ("rsq", 1), ("exp", 1), ("log", 1), ("pow", 2),
            ("sincos", 1), ("matrix", 1), ("min", 2), ("max", 2), ("cmp", 3)])
        to = self.chance.randint(0, 5)
        if name == "matrix":
            return self.product(to)
        if name == "sincos":
            letters = self.chance.choice(["x", "y", "xy"])
            at = self.source(1, True, {6, 7})
            self.written[to] = self.written.get(to, set()) - set("xyz") | set(letters)
            return "sincos r%d.%s, %s, c6, c7" % (to, letters, at)
        mask = self.chance.choice([15, 15, 15, 1, 2, 4, 8, 3, 7, 5, 14, 10])
        letters = "".join(LETTERS[i] for i in range(4) if mask >> i & 1)
        constants = set()
        if name == "crs":
            mask &= 7
            mask, letters = (mask, letters.replace("w", "")) if mask else (7, "xyz")
        reads = {"dp3": 7, "dp4": 15, "crs": 7, "nrm": 7 | mask}.get(name, mask)
        sources = [self.source(3 if name == "dp2add" and k < 2 else reads,
                               name in ("rcp", "rsq", "exp", "log", "pow") or (name == "dp2add" and k == 2), constants,
                               name == "crs", to if name in ("crs", "nrm", "pow") else None)
                   for k in range(count)]
        self.written.setdefault(to, set()).update(letters)
        modifier = self.chance.choice(["", "", "", "", "_pp"] if name == "frc" else ["", "", "", "", "_sat", "_pp", "_sat_pp"])
        return "%s%s r%d.%s, %s" % (name, modifier, to, letters, ", ".join(sources))

    def product(self, to):
        name = self.chance.choice(list(MATRICES))
        length, rows = MATRICES[name]
        first = self.chance.randint(0, 6 - rows)
        vector = self.source(2 ** length - 1, False, {0, 1}, but=to)
        while vector.lstrip("-")[0] == "c":  # the row is the second constant
            vector = self.source(2 ** length - 1, False, {0, 1}, but=to)
        self.written.setdefault(to, set()).update(LETTERS[:rows])
        return "%s r%d.%s, %s, c%d" % (name, to, LETTERS[:rows], vector, first)

    def program(self):
        lines = ["ps_2_0"]
        for i in range(6):
            values = [repr(round(self.chance.uniform(-3, 3), self.chance.randint(0, 7))) for _ in range(4)]
            lines.append("def c%d, %s" % (i, ", ".join(values)))
        lines += ["def c%d, %s" % (6 + i, ", ".join(values)) for i, values in enumerate(SINCOS)]
        lines.append("dcl t0")
        lines += [self.instruction() for _ in range(self.chance.randint(3, 25))]
        full = [n for n, has in self.written.items() if len(has) == 4]
        lines.append("mov oC0, " + ("r%d" % full[-1] if full else "t0"))
        return "\n".join(lines) + "\n"


class Interpreter:
    def __init__(self, name):
        self.name = name
        self.rounded = FORMATS[name]
        self.registers = {}

    def read(self, text):
        register, _, swizzle = text.lstrip("-").partition(".")
        components = (swizzle or LETTERS) * (4 if len(swizzle) == 1 else 1)
        values = self.registers.get(register, [None] * 4)
        values = [values[LETTERS.index(c)] for c in components]
        return [-v if text[0] == "-" and v is not None else v for v in values]

    def component(self, operation, s, i):
        rounded = self.rounded
        a, b, c = [v[i] for v in s] + [None] * (3 - len(s))
        if operation == "dp2add":
            return rounded(rounded(rounded(s[0][0] * s[1][0]) + rounded(s[0][1] * s[1][1])) + c)
        if operation.startswith("dp"):
            total = rounded(s[0][0] * s[1][0])
            for k in range(1, int(operation[2])):
                total = rounded(total + rounded(s[0][k] * s[1][k]))
            return total
        if operation == "nrm":
            squares = self.component("dp3", [s[0], s[0]], 0)
            by = LARGEST[self.name] if squares == 0 else inverse(rounded(root(squares)), rounded, self.name)
            return rounded(a * by)
        if operation == "crs":
            j, k = (i + 1) % 3, (i + 2) % 3
            return rounded(rounded(s[0][j] * s[1][k]) - rounded(s[0][k] * s[1][j]))
        if operation == "sincos":
            return self.sincos(s)[i]
        if operation in ("log", "pow"):
            result = rounded(logarithm(abs(a))) if a != 0 else -LARGEST[self.name]
            return result if operation == "log" else rounded(exponential(rounded(b * result)))
        return {"sub": lambda: rounded(a - b), "abs": lambda: abs(a), "exp": lambda: rounded(exponential(a)),
                "frc": lambda: rounded(a - rounded(Fraction(a.numerator // a.denominator))),
                "lrp": lambda: rounded(rounded(a * rounded(b - c)) + c),
                "mov": lambda: a, "add": lambda: rounded(a + b), "mul": lambda: rounded(a * b),
                "mad": lambda: rounded(rounded(a * b) + c), "min": lambda: min(a, b), "max": lambda: max(a, b),
                "cmp": lambda: b if a >= 0 else c, "rcp": lambda: inverse(a, rounded, self.name),
                "rsq": lambda: inverse(rounded(root(rounded(abs(a)))), rounded, self.name)}[operation]()

    def sincos(self, s):
        """cos and sin of an angle, by Horner's scheme for those of its half."""
        rounded = self.rounded
        angle, square = s[0][0], rounded(s[0][0] * s[0][0])
        first, second = s[1], s[2]
        halves = []
        for coefficients in ((first[0], first[3], second[0], second[3]), (first[1], first[2], second[1], second[2])):
            total = coefficients[0]
            for coefficient in coefficients[1:]:
                total = rounded(rounded(total * square) + coefficient)
            halves.append(total)
        sine, cosine = rounded(halves[0] * angle), halves[1]
        twice = rounded(sine * sine)
        both = rounded(sine * cosine)
        return rounded(second[2] - rounded(twice + twice)), rounded(both + both)

    def line(self, text):
        word, _, rest = text.partition(" ")
        operands = [o.strip() for o in rest.split(",")]
        if word == "def":
            self.registers[operands[0]] = [self.rounded(Fraction(float(x))) for x in operands[1:]]
        elif word not in ("dcl", "ps_2_0"):
            operation, *modifiers = word.split("_")
            register, _, mask = operands[0].partition(".")
            if operation in MATRICES:
                length, rows = MATRICES[operation]
                for row in range(rows):
                    self.line("dp%d %s.%s, %s, c%d" % (length, register, LETTERS[row], operands[1],
                                                       int(operands[2][1:]) + row))
                return
            sources = [[v if v is None else self.rounded(v) for v in self.read(o)] for o in operands[1:]]
            values = list(self.registers.get(register, [None] * 4))
            for c in mask or LETTERS:
                value = self.component(operation, sources, LETTERS.index(c))
                if "pp" in modifiers:
                    value = self.rounded(FORMATS["float16"](value))
                if "sat" in modifiers:
                    value = self.rounded(min(max(value, Fraction(0)), Fraction(1)))
                values[LETTERS.index(c)] = value
            self.registers[register] = values

    def run(self, text, u, v):
        self.registers["t0"] = [self.rounded(Fraction(x)) for x in (u, v, 0, 1)]
        for line in text.splitlines():
            self.line(line)
        return [struct.unpack("<f", struct.pack("<f", float(x)))[0] for x in self.registers["oC0"][:3]]


class Shader(unittest.TestCase):
    def test_programs_compute_as_fractions_rounded_to_their_formats_do(self):
        chance = random.Random(SEED)
        compared = 0
        for _ in range(PROGRAMS):
            text, name = Writer(chance).program(), chance.choice(list(FORMATS))
            result = subprocess.run([PROGRAM, "run", "-", "--size", "2", "--arithmetic", name], input=text.encode(),
                                    capture_output=True, timeout=100)
            self.assertEqual(result.stderr, b"", text)
            values = struct.unpack("<12f", result.stdout.split(b"\n", 3)[3])
            for y in range(2):
                for x in range(2):
                    try:
                        wanted = Interpreter(name).run(text, Fraction(2 * x + 1, 4), Fraction(2 * y + 1, 4))
                    except NotFinite:
                        continue
                    compared += 1
                    # The lowest row stands first.
                    self.assertEqual(list(values[((1 - y) * 2 + x) * 3:][:3]), wanted, "seed %d, %s\n%s" % (SEED, name, text))
        self.assertGreater(compared, 2 * PROGRAMS)


if __name__ == "__main__":
    unittest.main()
