#pragma once

namespace pbrt {

/// From here on this process can use at most so many bytes (its own mappings that can be written): allocating more
/// fails. A smaller limit that it has already stays.
void LimitMemory(double bytes);

}  // namespace pbrt
