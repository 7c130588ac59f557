"""Pictures of the bench `camera` by another renderer: camera_peers.py FOLDER RENDERER WIDTHxHEIGHT SHADOWS REPEATS

RENDERER is `mujoco` (OpenGL by Mesa's llvmpipe on one thread), `mujoco-boxes` or `pybullet` (its TinyRenderer); both are wheels, and
they need the wheel numpy. SHADOWS is `none`, `default` or, for MuJoCo, the width of its shadow map in texels (4096 by default). Reads the files that the bench has
written to FOLDER, writes the pictures to FOLDER/RENDERER.rgb (row by row from the top, one picture after the other), and prints the
seconds of all views in the fastest of REPEATS rounds, including the reading back of the pixels.

All settings that cost time are off: no multisampling, no specular light, no sky box, no fog, no reflection. The room is four meshes,
one for each texture, which both render fastest. For `mujoco-boxes` each box is a mesh.
"""

import os
import struct
import sys
import time
import zlib
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")
os.environ.setdefault("LP_NUM_THREADS", "0")

try:
    import numpy as np
except ImportError as error:
    sys.exit(f"{error}: install the wheels with `pip install mujoco pybullet numpy`")

MATERIALS = 4
FACES_OF_A_BOX = 12


class Scene:
    """Faces are rows of material, then x, y, z, u, v for each corner. Views are rows of eye, forward, left. Light is the direction
    towards the sun, ambient and diffuse."""

    def __init__(self, folder, is_split):
        def numbers(name, columns):
            return np.fromfile(folder / f"{name}.f64", "<f8").reshape(-1, columns)

        self.folder = folder
        self.faces = numbers("faces", 16)
        self.corners = self.faces[:, 1:].reshape(-1, 5)[:, :3]
        self.views = numbers("views", 9).reshape(-1, 3, 3)
        self.fov = float(numbers("fov", 1)[0, 0])
        light = numbers("light", 5)[0]
        self.towards, self.ambient, self.diffuse = light[:3], light[3], light[4]
        # Material of each mesh.
        self.meshes = []
        for material in range(MATERIALS):
            self.write_texture(material)
            faces = self.faces[self.faces[:, 0] == material][:, 1:].reshape(-1, 3, 5)
            for first in range(0, len(faces), FACES_OF_A_BOX if is_split else len(faces)):
                self.write_mesh(faces[first : first + FACES_OF_A_BOX] if is_split else faces)
                self.meshes.append(material)

    def write_texture(self, material):
        pixels = np.fromfile(self.folder / f"texture{material}.rgba", "u1")
        side = int(np.sqrt(len(pixels) // 4))
        rows = np.ascontiguousarray(pixels.reshape(side, side, 4)[:, :, :3])
        lines = b"".join(b"\0" + row.tobytes() for row in rows)

        def chunk(name, data):
            body = name + data
            return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

        header = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
        png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")
        (self.folder / f"texture{material}.png").write_bytes(png)

    def write_mesh(self, faces):
        normals = np.cross(faces[:, 1, :3] - faces[:, 0, :3], faces[:, 2, :3] - faces[:, 0, :3])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        lines = [f"v {c[0]!r} {c[1]!r} {c[2]!r}" for face in faces.tolist() for c in face]
        lines += [f"vt {c[3]!r} {c[4]!r}" for face in faces.tolist() for c in face]
        lines += [f"vn {n[0]!r} {n[1]!r} {n[2]!r}" for n in normals.tolist()]
        for face in range(len(faces)):
            lines.append("f " + " ".join(f"{3 * face + c}/{3 * face + c}/{face + 1}" for c in (1, 2, 3)))
        (self.folder / f"mesh{len(self.meshes)}.obj").write_text("\n".join(lines) + "\n")


def mujoco_frames(scene, size, shadows):
    """Returns a function that renders the picture of the view with a given number, row 0 at the top."""
    import mujoco

    width, height = size
    fovy = np.degrees(2 * np.arctan(np.tan(scene.fov / 2) * height / width))
    shadow_size = "" if shadows in ("none", "default") else f'shadowsize="{shadows}"'
    names, meshes = range(MATERIALS), enumerate(scene.meshes)
    textures = "".join(f'<texture type="2d" name="t{n}" file="texture{n}.png"/>' for n in names)
    looks = "".join(f'<material name="m{n}" texture="t{n}" specular="0" shininess="0"/>' for n in names)
    assets = "".join(f'<mesh name="o{n}" file="mesh{n}.obj" inertia="shell"/>' for n in range(len(scene.meshes)))
    geoms = "".join(
        f'<geom type="mesh" mesh="o{n}" material="m{material}" contype="0" conaffinity="0"/>' for n, material in meshes
    )
    cameras = ""
    for eye, forward, left in scene.views.tolist():
        up = np.cross(forward, left)
        axes = " ".join(map(repr, [-a for a in left] + up.tolist()))
        cameras += f'<camera pos="{eye[0]} {eye[1]} {eye[2]}" xyaxes="{axes}" fovy="{fovy}"/>'
    middle = scene.views[:, 0].mean(axis=0)
    sun = [c + 10 * t for c, t in zip(middle, scene.towards)]
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler meshdir="{scene.folder}" texturedir="{scene.folder}"/>
        <statistic center="4 4 0.5" extent="6"/>
        <visual><global offwidth="{width}" offheight="{height}"/><quality offsamples="0" {shadow_size}/>
        <headlight ambient="{scene.ambient} {scene.ambient} {scene.ambient}" diffuse="0 0 0" specular="0 0 0"/><map znear="0.005" zfar="10" shadowclip="1"/></visual>
        <asset>{textures}{looks}{assets}</asset><worldbody>
        <light type="directional" pos="{sun[0]} {sun[1]} {sun[2]}" dir="{-scene.towards[0]} {-scene.towards[1]} {-scene.towards[2]}"
        ambient="0 0 0" specular="0 0 0"
        diffuse="{scene.diffuse} {scene.diffuse} {scene.diffuse}"/>{geoms}{cameras}</worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    context_gl = mujoco.GLContext(width, height)
    context_gl.make_current()
    drawn = mujoco.MjvScene(model, maxgeom=1000)
    camera, option = mujoco.MjvCamera(), mujoco.MjvOption()
    camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
    camera.fixedcamid = 0
    mujoco.mjv_updateScene(model, data, option, None, camera, mujoco.mjtCatBit.mjCAT_ALL, drawn)
    flags = mujoco.mjtRndFlag
    for flag in (flags.mjRND_REFLECTION, flags.mjRND_SKYBOX, flags.mjRND_HAZE, flags.mjRND_FOG):
        drawn.flags[flag] = False
    drawn.flags[flags.mjRND_SHADOW] = shadows != "none"
    context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
    viewport = mujoco.MjrRect(0, 0, width, height)
    pixels = np.empty((height, width, 3), np.uint8)

    def frame(view):
        camera.fixedcamid = view
        mujoco.mjv_updateCamera(model, data, camera, drawn)
        mujoco.mjr_render(viewport, drawn, context)
        mujoco.mjr_readPixels(pixels, None, viewport, context)
        return pixels[::-1]

    frame.keep = (context_gl, context)
    return frame


def pybullet_frames(scene, size, shadows):
    """Returns a function that renders the picture of the view with a given number, row 0 at the top."""
    import pybullet

    width, height = size
    pybullet.connect(pybullet.DIRECT)
    # PyBullet's shadow map is around the origin.
    middle = 0.5 * (scene.corners.min(axis=0) + scene.corners.max(axis=0)) * [1, 1, 0]
    for number, material in enumerate(scene.meshes):
        name = str(scene.folder / f"mesh{number}.obj")
        shape = pybullet.createVisualShape(pybullet.GEOM_MESH, fileName=name, rgbaColor=[1, 1, 1, 1], specularColor=[0, 0, 0])
        body = pybullet.createMultiBody(baseVisualShapeIndex=shape, basePosition=(-middle).tolist())
        texture = pybullet.loadTexture(str(scene.folder / f"texture{material}.png"))
        pybullet.changeVisualShape(body, -1, textureUniqueId=texture)
    fovy = np.degrees(2 * np.arctan(np.tan(scene.fov / 2) * height / width))
    projection = pybullet.computeProjectionMatrixFOV(fovy, width / height, 0.03, 60.0)
    views = []
    for eye, forward, left in scene.views:
        eye = eye - middle
        views.append(pybullet.computeViewMatrix(eye.tolist(), (eye + forward).tolist(), np.cross(forward, left).tolist()))

    def frame(view):
        _, _, pixels, _, _ = pybullet.getCameraImage(
            width, height, views[view], projection,
            lightDirection=scene.towards.tolist(), lightDistance=10.0, shadow=int(shadows != "none"),
            lightAmbientCoeff=scene.ambient, lightDiffuseCoeff=scene.diffuse, lightSpecularCoeff=0.0,
            renderer=pybullet.ER_TINY_RENDERER, flags=pybullet.ER_NO_SEGMENTATION_MASK,
        )
        return pixels

    return frame


def main():
    if len(sys.argv) != 6:
        sys.exit(__doc__)
    folder, renderer = Path(sys.argv[1]), sys.argv[2]
    size = tuple(int(side) for side in sys.argv[3].split("x"))
    scene = Scene(folder, renderer == "mujoco-boxes")
    frame = (pybullet_frames if renderer == "pybullet" else mujoco_frames)(scene, size, sys.argv[4])
    count = len(scene.views)
    pictures = [np.array(frame(view)).reshape(size[1], size[0], -1)[:, :, :3].astype("u1") for view in range(count)]
    np.array(pictures).tofile(folder / f"{renderer}.rgb")
    best = np.inf
    for _ in range(int(sys.argv[5])):
        start = time.perf_counter()
        for view in range(count):
            frame(view)
        best = min(best, time.perf_counter() - start)
    print(best)
    # The clean-up of Mesa and MuJoCo may fail when the interpreter ends.
    sys.stdout.flush()
    os._exit(0)


main()
