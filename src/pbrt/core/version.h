#pragma once
#include <string>

namespace pbrt {

/// Name, version and commit of the build: "pbrt_octree 1.2.3 (commit 0123abc, modified)". Stored in metadata of images
/// and reports; must match when a render resumes. Defined by library pbrt_version, which is recompiled when the commit
/// changes.
const char *VersionText();

/// Identifies the running program: the linker's build ids, in hexadecimal, of the program and of the libraries whose
/// arithmetic affects images (Embree, libm). Changes with compiler, flags and sources.
std::string BuildId();

}  // namespace pbrt
