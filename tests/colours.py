"""How far apart colours look: CIEDE2000, and what dichromats and grey printing leave of a colour.

- sRGB: IEC 61966-2-1; CIELAB under D65.
- CIEDE2000: Sharma, Wu, Dalal, The CIEDE2000 color-difference formula, Color Res. Appl. 30 (2005) 21-30.
- Dichromats: Machado, Oliveira, Fernandes, A physiologically-based model for simulation of color vision
  deficiency, IEEE Trans. Vis. Comput. Graph. 15 (2009) 1291-1298, severity 1; they act on linear RGB.
"""

import numpy as np

_TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
_WHITE = _TO_XYZ.sum(axis=1)

SIMULATIONS = {
    "protanope": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranope": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "trichromat": np.eye(3),
    "grey": np.tile(_TO_XYZ[1], (3, 1)),
}


def linear(colour):
    """Linear RGB of sRGB in 0..1."""
    colour = np.asarray(colour, dtype=float)
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)


def seen_by(colour, who):
    """Linear RGB of an sRGB colour as it looks to a dichromat, or in grey."""
    return np.clip(linear(colour) @ SIMULATIONS[who].T, 0.0, 1.0)


def lab(rgb):
    """CIELAB of linear RGB."""
    share = rgb @ _TO_XYZ.T / _WHITE
    cubic = np.where(share > (6 / 29) ** 3, np.cbrt(share), share / (3 * (6 / 29) ** 2) + 4 / 29)
    x, y, z = np.moveaxis(cubic, -1, 0)
    return np.stack((116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)), axis=-1)


def _hue(b, a):
    return np.degrees(np.arctan2(b, a)) % 360.0


def _mean_hue(first, second, chromas):
    if chromas == 0.0:
        return first + second
    if abs(first - second) <= 180.0:
        return 0.5 * (first + second)
    return 0.5 * (first + second + (360.0 if first + second < 360.0 else -360.0))


def _hue_step(first, second, chromas):
    if chromas == 0.0:
        return 0.0
    return (second - first + 180.0) % 360.0 - 180.0 if abs(second - first) != 180.0 else second - first


def ciede2000(one, other):
    """Colour difference of two CIELAB colours; numbers of equations are those of Sharma et al."""
    (l1, a1, b1), (l2, a2, b2) = one, other
    mean_c = 0.5 * (np.hypot(a1, b1) + np.hypot(a2, b2))  # (2), (3)
    g = 0.5 * (1.0 - np.sqrt(mean_c**7 / (mean_c**7 + 25.0**7)))  # (4)
    a1, a2 = (1.0 + g) * a1, (1.0 + g) * a2  # (5)
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)  # (6)
    h1, h2 = _hue(b1, a1), _hue(b2, a2)  # (7)
    d_hue = _hue_step(h1, h2, c1 * c2)  # (10)
    d_h = 2.0 * np.sqrt(c1 * c2) * np.sin(np.radians(d_hue) / 2.0)  # (11)
    mean_l, mean_c, mean_h = 0.5 * (l1 + l2), 0.5 * (c1 + c2), _mean_hue(h1, h2, c1 * c2)  # (12)-(14)
    t = (
        1.0
        - 0.17 * np.cos(np.radians(mean_h - 30.0))
        + 0.24 * np.cos(np.radians(2.0 * mean_h))
        + 0.32 * np.cos(np.radians(3.0 * mean_h + 6.0))
        - 0.20 * np.cos(np.radians(4.0 * mean_h - 63.0))
    )  # (15)
    d_theta = 30.0 * np.exp(-(((mean_h - 275.0) / 25.0) ** 2))  # (16)
    r_c = 2.0 * np.sqrt(mean_c**7 / (mean_c**7 + 25.0**7))  # (17)
    s_l = 1.0 + 0.015 * (mean_l - 50.0) ** 2 / np.sqrt(20.0 + (mean_l - 50.0) ** 2)  # (18)
    s_c, s_h = 1.0 + 0.045 * mean_c, 1.0 + 0.015 * mean_c * t  # (19), (20)
    r_t = -np.sin(np.radians(2.0 * d_theta)) * r_c  # (21)
    chroma, hue = (c2 - c1) / s_c, d_h / s_h
    return np.sqrt(((l2 - l1) / s_l) ** 2 + chroma**2 + hue**2 + r_t * chroma * hue)  # (22)


def difference(one, other, who):
    """CIEDE2000 of two sRGB colours as `who` sees them."""
    return float(ciede2000(lab(seen_by(one, who)), lab(seen_by(other, who))))
