"""Machine files with ugly numbers, for tests of `hydrapod export`: joints off their circles, legs that differ."""
import math


def joint(generator, radius, angle):
    u = generator.uniform
    r, at = radius * u(0.9, 1.1), angle + u(-0.12, 0.12)
    return [r * math.cos(at), r * math.sin(at), radius * u(-0.08, 0.08)]


def joints(generator, base_radius, platform_radius):
    third = 2 * math.pi / 3
    half, half_base = generator.uniform(0.1, 0.35), generator.uniform(0.1, 0.35)
    base, platform = [], []
    for leg in range(6):
        pair, second = third * (leg // 2), leg % 2 == 1
        platform.append(joint(generator, platform_radius, pair + third - half if second else pair + half))
        base.append(joint(generator, base_radius, pair + third / 2 + (half_base if second else -half_base)))
    return base, platform


def random_machine(generator, gravity, damping="0.0031"):
    """The text of a machine file; with gravity the seals are stiff enough that the legs do not buckle."""
    u = generator.uniform

    def log(low, high):
        return math.exp(u(math.log(low), math.log(high)))

    mass, radius = log(200.0, 2e4), u(0.5, 2.0)
    base, platform = joints(generator, radius, radius * u(0.55, 0.9))
    height = radius * u(0.9, 1.6)
    lengths = [math.dist((p[0], p[1], p[2] + height), b) for p, b in zip(platform, base)]
    rod = min(lengths) * u(0.42, 0.52)
    sleeve = max(lengths) - rod + u(0.15, 0.3) * rod
    case_mass, rod_mass = mass * log(0.004, 0.05), mass * log(0.002, 0.03)
    oil = mass * log(3e3, 6e4)
    lever = sleeve - (min(lengths) - rod)  # from the piston to the seal, at most
    weight = 9.81 * mass / 6 * 1.6
    seal = log(2.0, 30.0) * weight * rod / (0.4 * lever) ** 2 if gravity else log(0.003, 0.2) * oil
    inertia = [mass * radius ** 2 * u(0.15, 0.3) for _ in range(2)]
    inertia.append(sum(inertia) * u(0.6, 0.95))
    across = rod_mass * rod ** 2 * u(0.06, 0.12)
    case_across = case_mass * sleeve ** 2 * u(0.06, 0.12)
    odd = generator.randrange(1, 7)
    return f"""name = "random"
[environment]
gravity = {9.81 if gravity else 0}
[base.joints]
points = {base}
[platform]
mass = {mass!r}
mass_center = [{u(-0.1, 0.1) * radius!r}, {u(-0.1, 0.1) * radius!r}, {u(-0.2, 0.3) * radius!r}]
inertia = {{ xx = {inertia[0]!r}, yy = {inertia[1]!r}, zz = {inertia[2]!r}, xy = {0.03 * inertia[0]!r} }}
[platform.joints]
points = {platform}
[model]
flexible_axes = "{generator.choice(['gimbal', 'transverse'])}"
[legs]
gimbal_axis = [{u(-0.3, 0.3)!r}, 1.0, 0.0]
gimbal_cross_inertia = {0.05 * case_across!r}
[legs.case]
mass = {case_mass!r}
mass_center = {sleeve * u(0.2, 0.7)!r}
transverse_inertia = {case_across!r}
axial_inertia = {0.07 * case_across!r}
[legs.rod]
length = {rod!r}
mass = {rod_mass!r}
mass_center = {rod * u(0.3, 0.7)!r}
transverse_inertia = {across!r}
axial_inertia = {0.07 * across!r}
[legs.guide_sleeve]
position = {sleeve!r}
stiffness = {seal!r}
[leg.{odd}.guide_sleeve]
stiffness = {seal * u(0.8, 2.5)!r}
[leg.{odd % 6 + 1}.rod]
mass = {rod_mass * u(1.1, 1.6)!r}
[legs.oil_spring]
stiffness = {oil!r}
[damping]
modal_ratio = {damping}
[poses.neutral]
position = [{u(-0.02, 0.02) * radius!r}, {u(-0.02, 0.02) * radius!r}, {height!r}]
"""
