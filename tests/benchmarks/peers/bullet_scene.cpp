// scree-peers-bullet: the shared scene in Bullet, concave triangle meshes (GImpact) or convex hulls.
//
// Physics: sequential impulses on velocities (10 iterations), no contact stiffness, single precision. A step is therefore 10
// to 100 times longer than that of a penalty code, and the forces of a bed at rest are not resolved.
// Lengths are in centimetres, since Bullet's own tolerances suit bodies of size about 1.
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <memory>

#include "core/base/command_line.hpp"
#include "core/base/error.hpp"
#include "tests/benchmarks/peers/peer_scene.hpp"
#include "tests/benchmarks/peers/rounds.hpp"

namespace {

constexpr const char* kTool = "scree-peers-bullet";
constexpr double kUnit = 100;  // lengths of Bullet in a metre

btVector3 to_bullet(const scree::Vec3& v, double unit) {
  return {static_cast<btScalar>(unit * v.x), static_cast<btScalar>(unit * v.y), static_cast<btScalar>(unit * v.z)};
}
scree::Vec3 from_bullet(const btVector3& v, double unit) { return (1 / unit) * scree::Vec3{v.x(), v.y(), v.z()}; }

/// A collision shape with the arrays that Bullet only points to.
struct BulletShape {
  std::vector<btScalar> coordinates;
  std::vector<int> indices;
  std::unique_ptr<btTriangleIndexVertexArray> triangles;
  std::unique_ptr<btCollisionShape> shape;
};

void make_shape(const scree::PeerShape& source, const std::string& mode, double margin, BulletShape& made) {
  for (const scree::Vec3& p : source.mesh.vertices)
    for (int c = 0; c < 3; ++c) made.coordinates.push_back(static_cast<btScalar>(kUnit * p[c]));
  for (const scree::Triangle& t : source.mesh.triangles) made.indices.insert(made.indices.end(), t.begin(), t.end());
  const int vertices = source.mesh.vertex_count();
  constexpr int kRow = 3 * sizeof(btScalar);
  if (mode == "hull") {
    made.shape = std::make_unique<btConvexHullShape>(made.coordinates.data(), vertices, kRow);
    made.shape->setMargin(static_cast<btScalar>(margin));
    return;
  }
  made.triangles = std::make_unique<btTriangleIndexVertexArray>(source.mesh.triangle_count(), made.indices.data(), int(3 * sizeof(int)),
                                                                vertices, made.coordinates.data(), kRow);
  auto mesh = std::make_unique<btGImpactMeshShape>(made.triangles.get());
  mesh->setMargin(static_cast<btScalar>(margin));
  mesh->updateBound();
  made.shape = std::move(mesh);
}

int run(int argc, char** argv) {
  std::string folder, start, end, mode = "gimpact";
  double step = 1e-3, length = 0, margin = 0, density = 2600, gravity = 9.81, friction = 0.5, restitution = 0.3;
  int steps = 100;
  const auto app =
      scree::make_command_line(kTool, "Runs the shared scene in Bullet and prints CPU seconds as JSON.",
                               {{"scree-peers-bullet SHAPES START.state END.state --length 0.11", "100 steps of concave meshes"}});
  app->add_option("shapes", folder, "Folder of the shapes")->required();
  app->add_option("start", start, "State to start from")->required();
  app->add_option("end", end, "State to write")->required();
  app->add_option("--mode", mode, "gimpact or hull")->check(CLI::IsMember({"gimpact", "hull"}))->capture_default_str();
  app->add_option("--length", length, "Of the square box [m]")->required();
  app->add_option("--margin", margin, "Of each body [m]")->capture_default_str();
  app->add_option("--step", step, "[s]")->capture_default_str();
  app->add_option("--steps", steps, "How many")->capture_default_str();
  app->add_option("--density", density, "[kg/m^3]")->capture_default_str();
  app->add_option("--gravity", gravity, "[m/s^2]")->capture_default_str();
  app->add_option("--friction", friction, "Of a pair")->capture_default_str();
  app->add_option("--restitution", restitution, "Of a pair")->capture_default_str();
  if (!scree::parse_command_line(*app, argc, argv)) return 0;

  // 1 the world
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher);
  world.setGravity({0, 0, static_cast<btScalar>(-kUnit * gravity)});

  // 2 shapes and bodies; Bullet multiplies the coefficients of two bodies
  const std::vector<scree::PeerShape> sources = scree::read_peer_shapes(folder);
  std::vector<BulletShape> shapes(sources.size());
  for (std::size_t k = 0; k < sources.size(); ++k) make_shape(sources[k], mode, kUnit * margin, shapes[k]);
  std::vector<scree::PeerBody> states = scree::read_peer_state(start);
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  std::vector<std::unique_ptr<btStaticPlaneShape>> planes;
  const auto add = [&](double mass, btCollisionShape* shape, const btVector3& inertia) -> btRigidBody& {
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, shape, inertia);
    info.m_friction = static_cast<btScalar>(std::sqrt(friction));
    info.m_restitution = static_cast<btScalar>(std::sqrt(restitution));
    bodies.push_back(std::make_unique<btRigidBody>(info));
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(bodies.back().get());
    return *bodies.back();
  };
  for (const scree::PeerBody& s : states) {
    const scree::PeerShape& shape = sources.at(static_cast<std::size_t>(s.shape));
    btRigidBody& body = add(density * shape.volume, shapes.at(static_cast<std::size_t>(s.shape)).shape.get(),
                            to_bullet(density * shape.moments, kUnit * kUnit));
    const scree::Quat& q = s.orientation;
    body.setWorldTransform(
        btTransform(btQuaternion(btScalar(q.x), btScalar(q.y), btScalar(q.z), btScalar(q.w)), to_bullet(s.position, kUnit)));
    body.setLinearVelocity(to_bullet(s.velocity, kUnit));
    body.setAngularVelocity(to_bullet(s.angular_velocity, 1));
    body.updateInertiaTensor();
  }
  const auto side = static_cast<btScalar>(kUnit * length);
  for (const auto& [normal, offset] : std::initializer_list<std::pair<btVector3, btScalar>>{
           {{0, 0, 1}, 0}, {{1, 0, 0}, 0}, {{-1, 0, 0}, -side}, {{0, 1, 0}, 0}, {{0, -1, 0}, -side}}) {
    planes.push_back(std::make_unique<btStaticPlaneShape>(normal, offset));
    add(0, planes.back().get(), {0, 0, 0});
  }

  // 3 one step to build what is built once, then the steps that count
  world.stepSimulation(static_cast<btScalar>(step), 0);
  const double begin = scree::cpu_seconds();
  for (int i = 0; i < steps; ++i) world.stepSimulation(static_cast<btScalar>(step), 0);
  const double cpu = scree::cpu_seconds() - begin;

  // 4 the end
  for (std::size_t i = 0; i < states.size(); ++i) {
    const btTransform& t = bodies[i]->getWorldTransform();
    const btQuaternion q = t.getRotation();
    states[i].position = from_bullet(t.getOrigin(), kUnit);
    states[i].orientation = scree::normalised(scree::Quat{q.w(), q.x(), q.y(), q.z()});
    states[i].velocity = from_bullet(bodies[i]->getLinearVelocity(), kUnit);
    states[i].angular_velocity = from_bullet(bodies[i]->getAngularVelocity(), 1);
  }
  scree::write_peer_state(end, states);
  std::puts(nlohmann::json{{"cpu", cpu}, {"steps", steps}, {"version", btGetVersion()}}.dump().c_str());
  for (const auto& body : bodies) world.removeRigidBody(body.get());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return scree::run_main(kTool, [&] { return run(argc, argv); });
}
