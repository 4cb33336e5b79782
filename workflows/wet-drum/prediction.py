"""The angle at which an avalanche starts in a wet bed, from that of the dry bed and the pressure of the liquid bridges (angles.py has the source)."""
import math


def predicted_start(dry, pressure):
    """Solution below 90 degrees of tan(theta) = tan(dry) (1 + pressure / cos(theta)) [rad]; None where there is none: from tan(dry) pressure = 1 on the bridges alone
    hold the bed on a vertical slope. pressure: p_c / (rho g h).

    The equation is sin(theta - dry) = pressure sin(dry).
    """
    if not math.tan(dry) * pressure < 1:   # not a number: no pressure is known
        return None
    return float(dry + math.asin(pressure * math.sin(dry)))
