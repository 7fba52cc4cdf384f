// Three lines of obscura's in a program with Rapier: a ball, a crate and a capsule fall onto a slope.
import RAPIER from "@dimforge/rapier2d-compat";
import { Recorder } from "./obscura_rapier.mjs";

await RAPIER.init();
const world = new RAPIER.World({ x: 0, y: -9.81 });
const { RigidBodyDesc, ColliderDesc } = RAPIER;
const add = (name, body, shape) =>
  world.createCollider(shape.setFriction(0.6).setRestitution(0.5), Object.assign(world.createRigidBody(body), { userData: name }));

add("slope", RigidBodyDesc.fixed().setTranslation(0.5, 0.2).setRotation(-0.08), ColliderDesc.cuboid(2.5, 0.05));
add("ball", RigidBodyDesc.dynamic().setTranslation(0, 2), ColliderDesc.ball(0.2));
add("crate", RigidBodyDesc.dynamic().setTranslation(0.9, 1.4).setRotation(0.3), ColliderDesc.cuboid(0.3, 0.2));
add("rod", RigidBodyDesc.dynamic().setTranslation(1.2, 2.2).setRotation(1.2), ColliderDesc.capsule(0.2, 0.08));

const film = new Recorder(RAPIER, world, "run", 60);
for (let step = 0; step <= 90; ++step) {
  film.frame();
  world.step();
}
