#include "post/statistics/tables.hpp"

#include <fmt/format.h>

#include "core/base/long_work.hpp"
#include "post/run/output_file.hpp"

namespace scree {

void write_bodies_table(const Run& run, const std::string& path) {
  OutputFile file(path);
  file.add("time,id,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz\n");
  LongWork work("frames", static_cast<double>(run.frames.size()));
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    work.advance();
    const Frame frame = load_frame(run, f);
    const FrameBodies& b = frame.bodies;
    std::string rows;
    for (std::size_t i = 0; i < b.size(); ++i) {
      const Vec3 &x = b.position[i], &v = b.velocity[i], &w = b.angular_velocity[i];
      const Quat& q = b.orientation[i];
      rows += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", frame.time, b.id[i], x.x, x.y, x.z, v.x, v.y, v.z, q.w, q.x,
                          q.y, q.z, w.x, w.y, w.z);
    }
    file.add(rows);
  }
  file.commit();
}

void write_contacts_table(const Run& run, const std::string& path) {
  OutputFile file(path);
  file.add("time,body_a,body_b,feature,x,y,z,nx,ny,nz,depth,fn,ftx,fty,ftz\n");
  LongWork work("frames", static_cast<double>(run.frames.size()));
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    work.advance();
    const Frame frame = load_frame(run, f);
    const FrameContacts& c = frame.contacts;
    std::string rows;
    for (std::size_t i = 0; i < c.size(); ++i) {
      const Vec3 &x = c.point[i], &n = c.normal[i], &t = c.tangential_force[i];
      rows += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", frame.time, c.body_a[i], c.body_b[i], c.feature[i], x.x, x.y,
                          x.z, n.x, n.y, n.z, c.overlap[i], c.normal_force[i], t.x, t.y, t.z);
    }
    file.add(rows);
  }
  file.commit();
}

}  // namespace scree
