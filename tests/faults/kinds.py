"""The kinds of run that the fault campaign kills, small enough to be made many times."""

DRY_2D = """
title = "Grains settle between walls, then a gate opens and the bed is tilted"
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
spread = 0.2
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = true
[build]
kind = "box"
columns = 8
layers = 6
walls = "grains"
run_out = "4 cm"
[time]
steps_per_contact = 20
[[timeline]]
at = "0.05 s"
remove = "gate"
[[timeline]]
at = "0.09 s"
slope_angle = "10 deg"
[stop]
time = "0.2 s"
[record]
frames = "2 ms"
events = "all"
"""

DRY_3D = """
title = "A layer of grains in space, periodic, tilted on the way"
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
[contact]
stiffness = "200 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[build]
kind = "packing"
columns = 7
rows = 7
layers = 6
[time]
steps_per_contact = 20
[[timeline]]
at = "0.03 s"
slope_angle = "26 deg"
[stop]
time = "0.08 s"
[record]
frames = "1 ms"
events = "all"
"""

SALTATION = """
title = "Grains hop over fixed ones in a log law of water, until each has done so many saltations"
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
shear_ratio = 0.2857
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "locked"
plane = true
slope = "1/20"
[water]
profile = "log rough"
tau_star = 0.3
depth = "2 cm"
zero = "0.15 cm"
roughness = "0.2 cm"
drag = "24/Re+0.4"
added_mass = 0.5
[build]
kind = "saltation"
n_bed = 20
starts = 4
[time]
steps_per_contact = 50
[stop]
saltations = 8
time = "4 s"
[record]
frames = "5 ms"
events = "all"
settle = "0.2 s"
"""

TWO_WAY = """
title = "Grains over a bed and a column of water move each other, in eddies"
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
spread = 0.1
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = true
slope = "1/20"
[water]
profile = "column"
depth = "1 cm"
buoyancy = "stress"
drag = "24/Re+0.4"
hindrance = "Di Felice"
torque = "Dennis"
density = "1000 kg/m3"
viscosity = "1e-6 m2/s"
[water.column]
start = "steady"
bed = "moving"
drive = "slope"
mixing_length = "Li-Sawamoto"
packed = 0.5
surface = "depth"
interval = 20
fluctuations = "random walk"
[build]
kind = "packing"
columns = 12
layers = 4
[time]
steps_per_contact = 20
[stop]
time = "0.15 s"
[record]
frames = "2 ms"
events = "all"
"""

ROLLING = """
title = "A heap of grains that resist rolling, until it rests"
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
spread = 0.2
[contact]
stiffness = "50 N/cm"
restitution = 0.3
friction_angle = "30 deg"
[rolling]
model = "spring-dashpot-slider"
arm = "reduced radius"
coefficient = 0.2
[motion]
rotation = "free"
plane = true
[build]
kind = "box"
columns = 6
layers = 5
run_out = "3 cm"
[time]
steps_per_contact = 20
[[timeline]]
at = "0.1 s"
remove = "gate"
[stop]
time = "0.6 s"
rest = { speed = "5 mm/s", duration = "0.05 s" }
[record]
frames = "5 ms"
events = "all"
"""

WALLS = """
title = "Grains in a drum of triangles and discs that turns, stops and swings"
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
spread = 0.2
[contact]
stiffness = "50 N/cm"
restitution = 0.5
friction = 0.5
[rolling]
model = "spring-dashpot-slider"
arm = "reduced radius"
coefficient = 0.1
[motion]
rotation = "free"
plane = false
[[walls]]
name = "drum"
shape = "cylinder"
at = ["0 cm", "0 cm", "0 cm"]
axis = ["0 cm", "1.6 cm", "0 cm"]
radius = "2 cm"
ends = "closed"
angular_velocity = ["0 rpm", "100 rpm", "0 rpm"]
axis_point = ["0 cm", "0 cm", "0 cm"]
[[walls]]
name = "shelf"
shape = "rectangle"
at = ["-1.9 cm", "0 cm", "-3 mm"]
sides = [["6 mm", "0 cm", "0 cm"], ["0 cm", "1.6 cm", "0 cm"]]
[build]
kind = "fill"
low = ["-1.2 cm", "0 cm", "-1.3 cm"]
high = ["1.2 cm", "1.6 cm", "1.3 cm"]
[time]
steps_per_contact = 10
[[timeline]]
at = "0.06 s"
move = { wall = "drum" }
[[timeline]]
at = "0.08 s"
move = { wall = "drum", amplitude = ["1 mm", "0 mm", "0 mm"], frequency = "40 Hz" }
[[timeline]]
at = "0.1 s"
remove = "shelf"
[stop]
time = "0.15 s"
[record]
frames = "2 ms"
events = "all"
"""

FEEDS = """
title = "Grains fall from a hose and a box on a plate; some leave, some of those come back, and it is tilted"
seed = 3
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
spread = 0.2
[contact]
stiffness = "50 N/cm"
restitution = 0.5
friction = 0.5
[rolling]
model = "spring-dashpot-slider"
arm = "reduced radius"
coefficient = 0.1
[motion]
rotation = "free"
plane = false
[build]
kind = "empty"
plate = "1.5 cm"
[[feeds]]
name = "hose"
centre = ["0 cm", "0 cm", "2.5 cm"]
radius = "8 mm"
rate = "600 grains/s"
velocity = ["0 m/s", "0 m/s", "-0.6 m/s"]
end = "0.12 s"
[[feeds]]
name = "box"
low = ["-1 cm", "-1 cm", "3 cm"]
high = ["1 cm", "1 cm", "4 cm"]
rate = "0.02 kg/s"
velocity = ["0.1 m/s", "0 m/s", "-0.5 m/s"]
begin = "0.02 s"
end = "0.1 s"
[[exits]]
name = "below"
point = ["0 cm", "0 cm", "-1 cm"]
normal = [0, 0, -1]
[[exits]]
name = "side"
low = ["1 cm", "-4 cm", "-1 cm"]
high = ["6 cm", "4 cm", "6 mm"]
to = "hose"
[time]
steps_per_contact = 10
[[timeline]]
at = "0.14 s"
slope_angle = "20 deg"
[stop]
time = "0.2 s"
[record]
frames = "2 ms"
events = "all"
"""

ELASTIC = """
title = "Elastic spheres of two sizes settle in a periodic cell and are tilted"
[grains]
diameter = "2 mm"
density = "2650 kg/m3"
spread = 0.3
[contact]
law = "Hertz-Mindlin"
youngs_modulus = "20 MPa"
poisson_ratio = 0.3
expected_speed = "0.2 m/s"
restitution = 0.6
friction = 0.5
[motion]
rotation = "free"
plane = false
[build]
kind = "packing"
columns = 6
rows = 6
layers = 5
[[timeline]]
at = "0.03 s"
slope_angle = "26 deg"
[stop]
time = "0.06 s"
[record]
frames = "1 ms"
events = "all"
"""

SERVO = """
title = "A lid is pressed on grains in a box and drawn along"
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
[contact]
stiffness = "2000 N/m"
restitution = 0.5
friction = 0.3
[motion]
rotation = "free"
plane = false
[[planes]]
name = "left"
point = ["0 cm", "0 cm", "0 cm"]
normal = [1, 0, 0]
[[planes]]
name = "right"
point = ["2.4 cm", "0 cm", "0 cm"]
normal = [-1, 0, 0]
[[planes]]
name = "front"
point = ["0 cm", "0 cm", "0 cm"]
normal = [0, 1, 0]
[[planes]]
name = "back"
point = ["0 cm", "2.4 cm", "0 cm"]
normal = [0, -1, 0]
[[planes]]
name = "floor"
point = ["0 cm", "0 cm", "0 cm"]
normal = [0, 0, 1]
[[walls]]
name = "lid"
shape = "rectangle"
at = ["-3 cm", "0 cm", "2 cm"]
sides = [["8 cm", "0 cm", "0 cm"], ["0 cm", "2.4 cm", "0 cm"]]
velocity = ["5 cm/s", "0 cm/s", "0 cm/s"]
servo = { direction = [0, 0, -1], force = "0.1152 N", max_speed = "10 cm/s", max_travel = "1.5 cm" }
[build]
kind = "fill"
low = ["0 mm", "0 mm", "0 mm"]
high = ["2.4 cm", "2.4 cm", "1.8 cm"]
[stop]
time = "0.3 s"
[record]
frames = "2 ms"
events = "all"
"""

SERVO_FEEDS = """
title = "A lid follows a bed that is drawn off below and fed beside it, and the box is tilted"
[grains]
diameter = "4 mm"
density = "2650 kg/m3"
spread = 0.1
[contact]
stiffness = "2000 N/m"
restitution = 0.5
friction = 0.3
[motion]
rotation = "free"
plane = false
[[planes]]
name = "left"
point = ["0 cm", "0 cm", "0 cm"]
normal = [1, 0, 0]
[[planes]]
name = "right"
point = ["2.4 cm", "0 cm", "0 cm"]
normal = [-1, 0, 0]
[[planes]]
name = "front"
point = ["0 cm", "0 cm", "0 cm"]
normal = [0, 1, 0]
[[planes]]
name = "back"
point = ["0 cm", "2.4 cm", "0 cm"]
normal = [0, -1, 0]
[[planes]]
name = "floor"
point = ["0 cm", "0 cm", "0 cm"]
normal = [0, 0, 1]
[[walls]]
name = "lid"
shape = "rectangle"
at = ["1.1 cm", "0 cm", "1.7 cm"]
sides = [["1.3 cm", "0 cm", "0 cm"], ["0 cm", "2.4 cm", "0 cm"]]
servo = { direction = [0, 0, -1], force = "0.5 N", max_speed = "20 cm/s", max_travel = "1.6 cm" }
[[walls]]
name = "partition"
shape = "rectangle"
at = ["1 cm", "0 cm", "1.4 cm"]
sides = [["0 cm", "2.4 cm", "0 cm"], ["0 cm", "0 cm", "4 cm"]]
[build]
kind = "fill"
low = ["0 mm", "0 mm", "0 mm"]
high = ["2.4 cm", "2.4 cm", "1.4 cm"]
[[feeds]]
name = "hose"
centre = ["5 mm", "12 mm", "4 cm"]
radius = "4 mm"
rate = "150 grains/s"
velocity = ["0 m/s", "0 m/s", "-0.4 m/s"]
begin = "0.05 s"
[[exits]]
name = "hatch"
low = ["1.4 cm", "0.7 cm", "-5 mm"]
high = ["2.2 cm", "1.5 cm", "2.2 mm"]
[time]
steps_per_contact = 20
[[timeline]]
at = "0.21 s"
slope_angle = "5 deg"
[stop]
time = "0.3 s"
[record]
frames = "2 ms"
events = "all"
"""

CLUMPS = """
title = "Clumps and spheres fall on a bed, periodic, which is tilted on the way"
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
spread = 0.2
shape = { rod = 0.4, tetrahedron = 0.4 }
[contact]
stiffness = "100 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
[build]
kind = "packing"
columns = 5
rows = 4
layers = 6
speed = "20 cm/s"
[time]
steps_per_contact = 20
[[timeline]]
at = "0.03 s"
slope_angle = "20 deg"
[stop]
time = "0.08 s"
[record]
frames = "2 ms"
events = "all"
"""

CLUMPS_IN_WATER = """
title = "Clumps and spheres in a column of flowing water over a rough bed"
[grains]
diameter = "0.2 cm"
density = "2650 kg/m3"
spread = 0.2
shape = { rod = 0.4, tetrahedron = 0.4 }
[contact]
stiffness = "100 N/cm"
restitution = 0.5
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = false
slope = 0.02
[water]
profile = "column"
depth = "2 cm"
drag = "Schiller-Naumann"
drag_of_form = "Bagheri-Bonadonna"
torque = "Dennis"
lift = "Wiberg-Smith"
[build]
kind = "flume"
length = "1.6 cm"
width = "1.2 cm"
layers = 2
[time]
steps_per_contact = 20
[stop]
time = "0.03 s"
[record]
frames = "2 ms"
events = "all"
"""

KINDS = {
    "dry-2d": DRY_2D, "dry-3d": DRY_3D, "saltation": SALTATION, "two-way": TWO_WAY, "rolling": ROLLING,
    "walls": WALLS, "feeds": FEEDS, "elastic": ELASTIC, "servo": SERVO, "servo-feeds": SERVO_FEEDS,
    "clumps": CLUMPS, "clumps-water": CLUMPS_IN_WATER,
}  # fmt: skip
