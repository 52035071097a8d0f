"""Plays one of the lab's scenes by a solver that is a package of Python.

    play.py versions
    play.py play SOLVER SETTING SCENE.json PLACES.f32

SETTING is read as the whole numbers in it. The scene is what `src/scene.rs` tells; of the places of all particles after half a
second, and in each frame of the last, floats are written. The last line printed is `ms`, the CPU time of a frame in the mean.
"""

import importlib.metadata
import json
import platform
import re
import sys
import time

import numpy

# After which frame places are compared with the reference's, and how many of the last are looked at: as in `src/scene.rs`.
COMPARED = 30
LAST = 60

# What stands for rigid springs where all must give (N/m).
STIFF = 1.0e7


class Pypbd:
    """Position Based Dynamics: XPBD, spring by spring. Numbers: sub-steps, one iteration each."""

    def __init__(self, scene, substeps):
        import pypbd

        simulation = pypbd.Simulation.getCurrent()
        simulation.initDefault()
        self.model = simulation.getModel()
        places = numpy.array(scene["positions"], dtype=float)
        corners = [corner for triangle in scene["triangles"] for corner in triangle]
        self.model.addTriangleModel(places, corners, testMesh=False)
        self.particles = self.model.getParticles()
        for index, mass in enumerate(scene["masses"]):
            self.particles.setMass(index, mass)
        for index in scene["pinned"]:
            self.particles.setMass(index, 0.0)
        for (a, b), compliance in zip(scene["springs"], scene["compliances"]):
            # To its solver a stiffness of 0 is rigid.
            stiffness = 1.0 / compliance if compliance > 0.0 else 0.0
            self.model.addDistanceConstraint_XPBD(a, b, stiffness)
        self.solver = simulation.getTimeStep()
        controller = pypbd.TimeStepController
        self.solver.setValueUInt(controller.NUM_SUB_STEPS, substeps)
        self.solver.setValueUInt(controller.MAX_ITERATIONS, 1)
        pypbd.TimeManager.getCurrent().setTimeStepSize(scene["frame"])

    def step(self):
        self.solver.step(self.model)

    def places(self):
        return numpy.array(self.particles.getVertices())


class Mujoco:
    """MuJoCo's flex: a membrane of finite elements, by the integrator `discrete`. Numbers: steps, and Young's modulus (MPa)."""

    def __init__(self, scene, steps, young):
        import mujoco

        self.mujoco = mujoco
        self.steps = steps

        def row(values):
            return " ".join(f"{value:.9g}" for each in values for value in each)

        ball, pins = "", ""
        if scene["ball"]:
            ball = f'<geom type="sphere" size="{scene["ball"]}" friction="{scene["friction"]} 0 0"/>'
        if scene["pinned"]:
            pins = f'<pin id="{" ".join(map(str, scene["pinned"]))}"/>'
        text = f"""
        <mujoco>
          <option timestep="{scene["frame"] / steps}" gravity="0 {-scene["gravity"]} 0" integrator="discrete"/>
          <size memory="1G"/>
          <worldbody>
            {ball}
            <flexcomp name="cloth" type="direct" dim="2" radius="0.001" mass="{sum(scene["masses"])}"
                point="{row(scene["positions"])}" element="{row(scene["triangles"])}">
              <elasticity young="{young * 1.0e6}" poisson="0" thickness="0.001" elastic2d="stretch"/>
              <contact selfcollide="none" friction="{scene["friction"]} 0 0"/>
              {pins}
            </flexcomp>
          </worldbody>
        </mujoco>"""
        self.model = mujoco.MjModel.from_xml_string(text)
        # It gives all particles the same mass.
        for body, mass in zip(self.model.flex_vertbodyid, scene["masses"]):
            if body != 0:
                self.model.body_inertia[body] *= mass / self.model.body_mass[body]
                self.model.body_mass[body] = mass
        self.data = mujoco.MjData(self.model)
        mujoco.mj_setConst(self.model, self.data)

    def step(self):
        for _ in range(self.steps):
            self.mujoco.mj_step(self.model, self.data)

    def places(self):
        # Those of the end of the step, which it would only find in the next.
        self.mujoco.mj_kinematics(self.model, self.data)
        self.mujoco.mj_comPos(self.model, self.data)
        self.mujoco.mj_flex(self.model, self.data)
        return self.data.flexvert_xpos.copy()


def colours(count, springs):
    """Particles in groups, of which no two in one share a spring."""
    neighbours = [set() for _ in range(count)]
    for a, b in springs:
        neighbours[a].add(b)
        neighbours[b].add(a)
    colour_of = [-1] * count
    for particle in range(count):
        taken = {colour_of[other] for other in neighbours[particle]}
        colour_of[particle] = next(colour for colour in range(count) if colour not in taken)
    return [
        numpy.array([index for index in range(count) if colour_of[index] == colour], dtype=numpy.int32)
        for colour in range(max(colour_of) + 1)
    ]


class Newton:
    """Newton, on the CPU: VBD and XPBD with springs, Style3D with a membrane. Numbers: steps, and iterations in each."""

    def __init__(self, kind, scene, steps, iterations, linear_iterations=10):
        import newton
        import warp

        warp.config.log_level = warp.LOG_ERROR if hasattr(warp, "LOG_ERROR") else 40
        warp.set_device("cpu")
        self.steps = steps
        self.seconds = scene["frame"] / steps
        pinned = set(scene["pinned"])
        masses = [0.0 if index in pinned else mass for index, mass in enumerate(scene["masses"])]
        builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=(0.0, -scene["gravity"], 0.0))
        if scene["ball"]:
            surface = newton.ModelBuilder.ShapeConfig(ke=1.0e4, kd=0.0, mu=scene["friction"])
            builder.add_shape_sphere(body=-1, radius=scene["ball"], cfg=surface)
        places = [warp.vec3(*place) for place in scene["positions"]]
        if kind == "style3d":
            from newton.solvers import style3d

            newton.solvers.SolverStyle3D.register_custom_attributes(builder)
            style3d.add_cloth_mesh(
                builder,
                pos=warp.vec3(0.0, 0.0, 0.0),
                rot=warp.quat_identity(),
                vel=warp.vec3(0.0, 0.0, 0.0),
                vertices=places,
                indices=[corner for triangle in scene["triangles"] for corner in triangle],
                density=sum(scene["masses"]) / scene["width"] ** 2,
                panel_verts=[warp.vec2(place[2], place[0]) for place in scene["positions"]],
                tri_aniso_ke=warp.vec3(STIFF, STIFF, STIFF),
                edge_aniso_ke=warp.vec3(0.0, 0.0, 0.0),
                particle_radius=0.001,
            )
            for index, mass in enumerate(masses):
                builder.particle_mass[index] = mass
        else:
            still = [warp.vec3(0.0, 0.0, 0.0)] * len(places)
            builder.add_particles(places, still, masses, [0.001] * len(places))
            if kind == "vbd" and scene["compliances"][0] == 0.0:
                first, second, third = map(list, zip(*scene["triangles"]))
                count = len(first)
                builder.add_triangles(first, second, third, tri_ke=[STIFF] * count, tri_ka=[STIFF] * count, tri_kd=[0.0] * count)
            else:
                for (a, b), compliance in zip(scene["springs"], scene["compliances"]):
                    stiffness = 1.0 / compliance if compliance > 0.0 else STIFF
                    builder.add_spring(a, b, stiffness, 0.0, 0.0)
        if kind == "vbd":
            builder.color()
            # It colours particles by their triangles, and knows of no springs.
            if not builder.tri_indices:
                builder.particle_color_groups = colours(len(places), scene["springs"])
        model = builder.finalize()
        model.soft_contact_ke = 1.0e4
        model.soft_contact_kd = 0.0
        model.soft_contact_mu = scene["friction"]
        solvers = newton.solvers
        if kind == "vbd":
            self.solver = solvers.SolverVBD(model, iterations=iterations)
        elif kind == "xpbd":
            self.solver = solvers.SolverXPBD(model, iterations=iterations)
        else:
            config = solvers.SolverStyle3D.Config(
                iterations=iterations, linear_iterations=linear_iterations
            )
            self.solver = solvers.SolverStyle3D(model, config=config)
        self.states = [model.state(), model.state()]
        self.control = model.control()
        self.pipeline = newton.CollisionPipeline(model)
        self.contacts = self.pipeline.contacts()
        self.collides = scene["ball"] is not None

    def step(self):
        for _ in range(self.steps):
            now, then = self.states
            now.clear_forces()
            if self.collides:
                self.pipeline.collide(now, self.contacts)
            self.solver.step(now, then, self.control, self.contacts, self.seconds)
            self.states = [then, now]

    def places(self):
        return self.states[0].particle_q.numpy()


SOLVERS = {
    "pypbd": Pypbd,
    "mujoco": Mujoco,
    "vbd": lambda *told: Newton("vbd", *told),
    "xpbd": lambda *told: Newton("xpbd", *told),
    "style3d": lambda *told: Newton("style3d", *told),
}


def play(solver, setting, told, written):
    with open(told, encoding="utf-8") as file:
        scene = json.load(file)
    numbers = [int(number) for number in re.findall(r"\d+", setting)]
    player = SOLVERS[solver](scene, *numbers)
    seconds = 0.0
    with open(written, "wb") as file:
        for frame in range(1, scene["frames"] + 1):
            clock = time.process_time()
            player.step()
            seconds += time.process_time() - clock
            if frame == COMPARED or frame + LAST > scene["frames"]:
                file.write(numpy.asarray(player.places(), dtype="<f4").tobytes())
    print("ms", 1.0e3 * seconds / scene["frames"])


def versions():
    packages = ["pypbd", "mujoco", "newton", "warp-lang", "numpy"]
    said = [f"{name} {importlib.metadata.version(name)}" for name in packages]
    print(", ".join([f"Python {platform.python_version()}", *said]))


if __name__ == "__main__":
    if sys.argv[1] == "versions":
        versions()
    else:
        play(*sys.argv[2:])
