#pragma once
#include <string>

namespace pbrt {

/// Identifies the running program: the linker's build ids, in hexadecimal, of the program and of the libraries whose
/// arithmetic affects images (Embree, libm). Changes with compiler, flags and sources.
std::string BuildId();

}  // namespace pbrt
