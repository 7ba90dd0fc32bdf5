#pragma once
#include "support/scene_text.h"

namespace pbrt::test {

constexpr uint32_t kLampsPerRoom = 48;

/// Two rooms side by side without ceilings, with a wall between them at x = 0. Lamps of the left room come first.
inline Objects TwoRooms() {
    Objects world;
    for (uint32_t i = 0; i < 2 * kLampsPerRoom; ++i) {
        const uint32_t room = i / kLampsPerRoom, k = i % kLampsPerRoom;
        world.PointLight(fmt::format("{} {} {}", (room == 0 ? -3.7 : 0.2) + 0.5 * (k % 8), 0.6 + 0.1 * (k % 3),
                                     -1.5 + 0.6 * (k / 8)),
                         fmt::format("{} 1 1", 0.5 + 0.1 * (k % 5)));
    }
    return world.Material("diffuse").Quad("-4 0 -3  4 0 -3  -4 0 3  4 0 3").Quad("0 0 -3  0 0 3  0 2 -3  0 2 3");
}

}  // namespace pbrt::test
