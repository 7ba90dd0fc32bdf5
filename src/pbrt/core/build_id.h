#pragma once
#include <string>

namespace pbrt {

/// Names the very program that runs: the linker's build id (a hash of all its code) in hexadecimal digits, and those of
/// the libraries whose arithmetic decides pictures (Embree, libm). Another compiler, other flags or other sources give
/// another text.
std::string BuildId();

}  // namespace pbrt
