"""Spectra of h by brute force: bodies move in time, the phase of each path follows, the periodogram of sin(phase) is taken.

Definitions: docs/theory/motion.md (inputs, gains, chains), eq. 2.2, 6.8, 9.1 and 9.2. Eq. 1.10 to 1.13, which the program
uses, do not appear here. Motion has the period of the record, so that the periodogram has no leakage.
"""
import numpy as np

RATE, SECONDS = 1024, 64
COORDINATES = ("x", "y", "z", "rx", "ry", "rz")
C = 299792458.0
LEAST = 1e-3
LOSS = 75e-6      # of power per round trip of an arm, the default


def chain(links, f):
    """Transfer function with exp(-2 pi i f t)."""
    h = np.ones(len(f), complex)
    for link in links or []:
        (kind, values), = link.items()
        x = f / values["frequency"]
        loss = 1j * x / values["quality"]
        h *= (1 - loss if kind == "resonance" else 1) / (1 - x * x - loss)
    return h


def inputs(scene, body, coordinate, f):
    """{input: (term, transfer function)} of a coordinate of a body."""
    found = {}

    def add(key, term, h):
        found[key] = (term, h + found[key][1] if key in found else h)

    for i, term in enumerate(scene.bodies[body].terms.get(coordinate, [])):
        if "from" in term:
            for key, (source, h) in inputs(scene, term["from"], term["axis"], f).items():
                add(key, source, h * term.get("scale", 1) * chain(term.get("through"), f))
        else:
            add((body, coordinate, i), term, np.full(len(f), term.get("scale", 1), complex))
    for other, links in scene.bodies[body].joins:
        for key, (source, h) in inputs(scene, other, coordinate, f).items():
            add(key, source, h * chain(links, f))
    return found


def density(term, f):
    """One-sided PSD of a spectral input."""
    if "line" in term:
        at, width, rms = term["line"]
        return rms**2 * np.exp(-(f - at)**2 / (2 * width**2)) / (np.sqrt(2 * np.pi) * width)
    asd, at, exponent, low, high = term["power-law"]
    psd = asd**2 * (np.maximum(f, 1e-3) / at)**(2 * exponent)
    inside = 0.5 * ((f >= low) & (f < high)).astype(float) + 0.5 * ((f > low) & (f <= high))
    return psd * inside


class Shaker:
    """Draws of the motion of all bodies."""

    def __init__(self, scene):
        self.f = np.fft.rfftfreq(RATE * SECONDS, 1 / RATE)
        self.gains = {}
        for body in scene.bodies:
            for i, coordinate in enumerate(COORDINATES):
                found = inputs(scene, body, coordinate, self.f)
                if found:
                    self.gains[body, i] = found
        self.terms = {key: term for found in self.gains.values() for key, (term, _) in found.items()}

    def amplitude(self, term, rng):
        """Half of the complex amplitude of each line of the record."""
        if "sine" in term:
            peak, frequency, phase = term["sine"]
            lines = np.zeros(len(self.f), complex)
            lines[round(frequency * SECONDS)] = peak / 2 * np.exp(1j * phase)
            return lines
        noise = rng.standard_normal(len(self.f)) + 1j * rng.standard_normal(len(self.f))
        return np.sqrt(density(term, self.f) / SECONDS) / 2 * noise

    def draw(self, rng):
        """{(body, coordinate): motion [m, rad] in time}."""
        drawn = {key: self.amplitude(term, rng) for key, term in self.terms.items()}
        n = RATE * SECONDS
        return {place: np.fft.irfft(sum(np.conj(h) * drawn[key] for key, (_, h) in found.items()), n) * n
                for place, found in self.gains.items()}


def response(scene, f):
    """|T_ph|^2 + |T_am|^2 of an arm (eq. 6.8, 9.1, 9.2)."""
    ti, ts = scene.input_transmission, scene.signal_transmission
    effective = ti * ts / (1 - np.sqrt((1 - ti) * (1 - ts)))**2
    r = np.sqrt((1 - effective) * (1 - LOSS))
    gain, pole = 1 / (1 - r), C * (1 - r) / (4 * np.pi * scene.arm_length * np.sqrt(r))
    phase = scene.wavelength / (4 * np.pi * scene.arm_length)
    with np.errstate(divide="ignore"):
        push = 8 * scene.power * gain / (C * scene.mirror_mass * (2 * np.pi * f)**2 * scene.arm_length)
    return phase**2 + push**2 / (1 + (f / pole)**2)


def strain(scene, answer, reverse, edges, seed, draws=64, paths=4):
    """One-sided PSD of h in bins, of one route: two equal arms, C_rev = reverse; its error; and which bins can be compared.

    As in the program the response is that at the centre of a bin (docs/theory/spectra.md). Bins below LEAST of the highest
    PSD of the field cannot be compared, since the program takes weak motion to first order, nor those at whose edges a
    tone may fall on either side.
    """
    rng = np.random.default_rng(seed)
    shaker = Shaker(scene)
    share = np.cumsum(answer.weight) / answer.weight.sum()
    count = draws * paths
    chosen = rng.permutation(np.searchsorted(share, (np.arange(count) + rng.random()) / count))
    width = 1 / SECONDS
    result, cuts, cut = np.empty((draws, len(edges) - 1)), np.rint(edges * SECONDS).astype(int), np.zeros(len(edges))
    for d in range(draws):
        moved = shaker.draw(rng)
        total = np.zeros(len(shaker.f))
        for p in chosen[d * paths:(d + 1) * paths]:
            phase = sum(answer.levers[body][p, i] * x for (body, i), x in moved.items())
            power = np.abs(np.fft.fft(np.exp(1j * phase)))**2 / (2 * RATE * RATE * SECONDS)
            half = len(power) // 2
            total += np.append(power[:half], power[half]) + np.append(power[0], power[:half - 1:-1])
        power = total / paths * (shaker.f > edges[0] / 2)
        sums = np.concatenate([[0], np.cumsum(power)]) * width
        result[d] = np.diff(np.interp(edges, np.concatenate([[0], shaker.f + width / 2]), sums)) / np.diff(edges)
        cut += power[cuts] * width
    result *= 2 * reverse * answer.coupling[0]
    doubt = 2 * reverse * answer.coupling[0] * (cut[:-1] + cut[1:]) / draws / np.diff(edges)
    field, error = result.mean(0), result.std(0, ddof=1) / np.sqrt(draws)
    field_share = field / field.max()
    t = response(scene, np.sqrt(edges[1:] * edges[:-1]))
    return field * t, error * t, (field_share > LEAST) & (doubt < 0.05 * field)
