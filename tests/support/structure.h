#pragma once
#include <vector>

#include "pbrt/core/state_io.h"

namespace pbrt::test {

template <class T>
std::string BytesOf(const T &structure) {
    StateWriter writer;
    writer(structure);
    return writer.Joined();
}

/// The bytes of a state cut in two ways and overwritten.
inline std::vector<std::string> Damaged(const std::string &bytes) {
    return {bytes.substr(0, bytes.size() - 1), bytes.substr(0, 20), std::string(bytes.size(), '\x7f')};
}

/// Replaces element `index` of the vector that StateWriter::Structure wrote at byte `at`, and makes the hash fit.
template <class T>
std::string WithElement(std::string bytes, size_t at, size_t index, const T &value) {
    uint64_t count = 0;
    std::memcpy(&count, bytes.data() + at, sizeof(count));
    char *const first = bytes.data() + at + sizeof(count);
    std::memcpy(first + index * sizeof(T), &value, sizeof(T));
    const uint64_t hash = StructureHash({first, count * sizeof(T)});
    std::memcpy(first + count * sizeof(T), &hash, sizeof(hash));
    return bytes;
}

}  // namespace pbrt::test
