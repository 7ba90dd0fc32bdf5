#pragma once
#include <cstddef>
#include <cstdint>

namespace pbrt {

/// A strong 32-bit index. Lower layers refer to objects of higher layers by ids, never by pointers.
template <class Tag>
struct Id {
    static constexpr uint32_t kNone = 0xffffffffu;
    uint32_t value = kNone;

    constexpr Id() = default;
    constexpr explicit Id(uint32_t v) : value(v) {}
    constexpr explicit Id(size_t v) : value(uint32_t(v)) {}
    constexpr explicit operator bool() const { return value != kNone; }
    friend constexpr auto operator<=>(const Id &, const Id &) = default;
};

using ShapeId = Id<struct ShapeTag>;  ///< one Shape object: a quadric or a whole mesh
using MaterialId = Id<struct MaterialTag>;
using MediumId = Id<struct MediumTag>;
using LightId = Id<struct LightTag>;  ///< dense index into the LightTable

}  // namespace pbrt
