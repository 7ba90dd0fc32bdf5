#pragma once

namespace pbrt {

/// Returns name, version and commit of this program, as of its build: "pbrt_octree 1.2.3 (commit 0123abc, modified)".
/// Written into the metadata of images and reports, and part of what a resumed run must agree with. Defined by the
/// library pbrt_version, which is compiled anew when the commit changes.
const char *VersionText();

}  // namespace pbrt
