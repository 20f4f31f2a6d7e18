"""Texts of cases that several tests fill in."""

SAND = """
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.5
friction = 0.3
[motion]
rotation = "free"
"""

FED = (
    SAND
    + """
plane = false
[build]
kind = "empty"
[[planes]]
name = "floor"
point = ["0 m", "0 m", "0 m"]
normal = [0, 0, 1]
[[feeds]]
name = "pipe"
centre = ["0 cm", "0 cm", "2 cm"]
radius = "1 cm"
velocity = ["0 m/s", "0 m/s", "-0.5 m/s"]
{keys}
[stop]
time = "0.3 s"
[record]
frames = "20 ms"
"""
)
