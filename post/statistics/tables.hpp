// Bodies and contacts of all frames as CSV tables in full double precision.
#pragma once

#include <string>

#include "post/run/run_folder.hpp"

namespace scree {

/// time,id,x,y,z,vx,vy,vz,qw,qx,qy,qz,wx,wy,wz: one row per body and frame, by time, then id. SI.
/// Numbers are the shortest text that reads back as the same double.
/// Fails: InputError (a damaged frame, named), SystemError (disk).   Cost: one frame in memory.
void write_bodies_table(const Run& run, const std::string& path);

/// time,body_a,body_b,feature,x,y,z,nx,ny,nz,depth,fn,ftx,fty,ftz: one row per contact and frame.
/// Normal from b to a, force on a.
void write_contacts_table(const Run& run, const std::string& path);

}  // namespace scree
