#include "hydrapod/model/machine_file.hpp"

namespace hydrapod::model {

namespace {
constexpr const char* starter =
    R"toml(# A hydraulic hexapod for hydrapod: six cylinders between a fixed base and a platform.
#
# Change the numbers to those of your machine, then try
#     hydrapod check FILE
#     hydrapod modes FILE
#
# Quantities are plain numbers in SI units and radians, or strings with a unit: 0.25, "250 mm",
# "12 deg", "1.4 GPa". Lines that begin with "#" are comments; keys that are commented out are
# optional and show their default, or an example where there is none.
#
# Frames. Base frame: origin at the centre of the base joint circle, z up towards the platform.
# Platform frame: origin at the centre of the platform joint circle, parallel to the base frame in
# the neutral pose.

name = "My motion platform"
# description = "What the machine is"
# source = "Where the numbers come from: drawings, data sheets, measurements"

[environment]
# gravity = "9.80665 m/s^2"             # along -z; or a vector [gx, gy, gz] in the base frame

# ---- Joints ----------------------------------------------------------------------------------
# On a circle, joints stand in three pairs: `spacing` is the distance between the two of a pair.
# Base pairs stand at 60, 180 and 300 degrees, platform pairs at 0, 120 and 240 degrees; leg 1 joins
# the platform pair at 0 to the base pair at 60 degrees, and so on counter-clockwise.
# Instead of a circle: points = [[x, y, z], ...], one point for each of the legs 1 to 6, in m.

[base.joints]
circle = { radius = "1.1 m", spacing = "250 mm" }

[platform.joints]
circle = { radius = "0.8 m", spacing = "250 mm" }

# ---- Platform with its payload ---------------------------------------------------------------

[platform]
mass = "1500 kg"
mass_center = [0, 0, "0.2 m"]           # in the platform frame
# Inertia tensor about the mass centre, in the axes of the platform frame [kg m^2].
# xy, xz, yz are the tensor's elements as they stand (default 0); or three rows of three numbers.
inertia = { xx = 500, yy = 550, zz = 800 }

# ---- Legs: what all six have in common -------------------------------------------------------
# Lengths are counted along the leg's axis from the base joint, unless it says otherwise.

[legs]
# added_axial_inertia = 0               # kg, oil column in the lines, seen at the piston
# gimbal_axis = [0, 1, 0]               # base-fixed axis of the lower gimbal, in the base frame;
                                        # matters with flexible_axes = "gimbal" only

[legs.case]                             # cylinder case
mass = "35 kg"
mass_center = "0.5 m"                   # from the base joint
transverse_inertia = "3 kg m^2"         # across the axis, about its mass centre
# axial_inertia = 0                     # kg m^2, about the axis; with flexible_axes = "gimbal" only

[legs.rod]                              # rod with piston
length = "1.05 m"                       # from the piston to the platform joint
mass = "22 kg"
mass_center = "0.5 m"                   # from the piston, towards the platform
transverse_inertia = "2 kg m^2"         # across the axis, about its mass centre
# axial_inertia = 0                     # kg m^2, about the axis; with flexible_axes = "gimbal" only

[legs.guide_sleeve]                     # the seals' O-rings where the rod leaves the cylinder
position = "1 m"                        # from the base joint
stiffness = "5 kN/mm"                   # lateral
damping = "2 kN s/m"                    # lateral, viscous; default 0

# [legs.piston_ring]                    # the O-ring under the piston's ring; without it: rigid
# stiffness = "20 kN/mm"                # lateral
# damping = 0                           # N s/m, lateral, viscous

[legs.stroke]                           # where the piston can be; optional with a given stiffness
retracted = "0.25 m"                    # from the base joint to the piston when retracted
length = "0.6 m"

# The oil as a spring along the leg: either `stiffness`, or the table `cylinder` it follows from.
[legs.oil_spring]
# stiffness = "20 kN/mm"
damping = "10 kN s/m"                   # along the leg, viscous; default 0

[legs.oil_spring.cylinder]
bore = "80 mm"
rod_diameter = "56 mm"
bulk_modulus = "1.4 GPa"                # of the oil without air
cap_dead_volume = "100 cm^3"            # base side, piston retracted; default 0
rod_dead_volume = "100 cm^3"            # rod side, piston extended; default 0
cap_line_volume = "150 cm^3"            # up to the valve; default 0
rod_line_volume = "150 cm^3"            # up to the valve; default 0
# volumes = "chambers"                  # the true volumes at the pose; "equal": both hold
# control_volume = "2 l"                # this much at every pose. Default of control_volume: the
                                        # mean of both chambers at mid stroke
# [legs.oil_spring.cylinder.air]        # air carried in the oil; without the table: none
# fraction = "1 %"                      # of the volume at atmospheric pressure
# pressure = "70 bar"                   # mean absolute pressure in the chambers
# polytropic = 1.4                      # 1 for slow changes, 1.4 for fast ones

# [legs.joint_limits]                   # largest tilt from the neutral pose; without them: any
# base = "35 deg"
# platform = "40 deg"

# ---- Servo-hydraulics, for `hydrapod simulate` ------------------------------------------------
# All of it is optional; what is not given follows from the machine, and `hydrapod check` says how.
# Pressures are absolute.

# [legs.valve]
# rated_flow = "150 l/min"              # at full opening; default: 0.5 m/s of the piston
# rated_pressure_drop = "70 bar"        # over both edges together
# overlap = 0                           # of the travel; negative: underlap
# laminar_pressure = "1 bar"            # below it the edges' flow is laminar
# natural_frequency = "600 rad/s"       # of the spool
# damping_ratio = 0.8
# rate_limit = 100                      # 1/s, of the travel
# leakage = "1.5 l/min"                 # null leakage; default: 1 % of the rated flow

# [legs.leakage]                        # of the cylinder
# internal = 1e-12                      # m^3/(s Pa); default: 1 % of the rated flow at full supply
# external = 0                          # m^3/(s Pa)

# [legs.friction]                       # of the seals, along the leg
# coulomb = "700 N"                     # default: 1 % of supply pressure times piston area
# breakaway = "1050 N"                  # default: 1.5 times `coulomb`
# viscous = "7 kN s/m"                  # default: 10 times `coulomb` per m/s
# stribeck_velocity = "20 mm/s"
# smoothing_velocity = "2 mm/s"         # of tanh(v / v_0)
# [legs.friction.bristles]              # LuGre instead of tanh
# stiffness = "50 kN/mm"
# damping = "5 kN s/m"

# [legs.joint_friction]                 # in both joints of a leg
# viscous = 0                           # N m s/rad
# coulomb = 0                           # N m
# smoothing_rate = 0.01                 # rad/s

# [legs.end_stops]
# stiffness = "400 kN/mm"               # default: 20 times the oil spring
# damping = 0.5                         # s/m: force k d (1 + damping dd/dt)

# [legs.equivalent_cylinder]            # with `oil_spring.stiffness` only
# area_ratio = 0.5                      # rod side to cap side
# area = "50 cm^2"                      # default: a sixth of the supply pressure bears the platform
# bulk_modulus = "1 GPa"

# [supply]
# pressure = "140 bar"
# return_pressure = "5 bar"
# pump_flow = "100 l/min"               # default: whatever is drawn
# line_volume = "1 l"                   # between pump and valves, with `pump_flow`
# cavitation_pressure = "0.5 bar"
# [supply.accumulator]                  # with `pump_flow`
# gas_volume = "10 l"                   # at the precharge
# precharge = "90 bar"
# polytropic = 1.4

# ---- One leg that differs: any key of [legs], and its own joints -----------------------------
# [leg.3.guide_sleeve]
# stiffness = "2 kN/mm"
#
# [leg.3]
# base_joint = [-1.1, 0.1, 0]           # m, in the base frame
# platform_joint = [-0.3, 0.7, 0]       # m, in the platform frame

# ---- Model and damping -----------------------------------------------------------------------

[model]
# flexible_axes = "transverse"          # the knee bends about axes normal to the leg; "gimbal":
                                        # about axes parallel to those of the lower gimbal

[damping]                               # what is not a named damper above
# modal_ratio = "2 %"                   # for every mode; default: this where nothing else damps,
                                        # else 0
# rayleigh_mass = 0                     # 1/s, alpha in C = alpha M + beta K
# rayleigh_stiffness = 0                # s, beta

# ---- Controller and sensors, for `hydrapod simulate` and `hydrapod modes --system` --------------
# All of it is optional; what is not given follows from the machine.

[controller]
# space = "pose"                        # or "leg": what the errors are taken of
# bandwidth = "20 rad/s"                # default: 0.3 of the lowest oil mode. Or `gain`, one or six,
                                        # in 1/s: gain = [20, 20, 20, 20, 20, 20]
# integral_time = "0.4 s"               # default: 8 / smallest gain; 0: none
# velocity_feedforward = 1
# feedback = "pressure"                 # or "acceleration", "none": what damps the oil modes
# feedback_damping = 0.4                # damping ratio it gives to the lowest of them
# sample_time = "1 ms"
# delay = 1                             # samples from reading the sensors to the new drive
# compensation = "load"                 # or "asymmetry", "none": speed per drive

# [controller.output]                   # shares of full drive
# limit = 1
# resolution = 3.0517578125e-5          # 16 bits over -1 to 1
# offset = 0                            # or six: the valves' nulls

# [sensors.length]
# resolution = "5 um"
# noise = "2 um"                        # RMS
# range = ["1.2 m", "2 m"]              # default: any
# [sensors.pressure]
# resolution = "2 kPa"
# noise = "5 kPa"
# [sensors.acceleration]
# resolution = 0.001                    # m/s^2
# noise = 0.01

# ---- Poses -----------------------------------------------------------------------------------
# Position of the platform frame's origin in the base frame; rotation [rx, ry, rz] is first about x,
# then about y, then about z, axes of the base (default [0, 0, 0]). "neutral" must be there; add
# your own under any name.

[poses.neutral]
position = [0, 0, "1.4 m"]

[poses.high]
position = [0, 0, "1.55 m"]

[poses.rolled]
position = [0, 0, "1.4 m"]
rotation = ["10 deg", 0, 0]
)toml";
}  // namespace

std::string starter_machine_file() { return starter; }

}  // namespace hydrapod::model
