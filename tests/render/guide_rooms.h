#pragma once
#include <string>

#include "ext/guiding/path_guide.h"
#include "pbrt/build/built_scene.h"

namespace pbrt::test {

constexpr int kGuideSamples = 64;  ///< per pixel; the guide learns after 2, 8 and 32

/// What is special about a room of 6 x 2 x 6, grey-brown, with a camera at its front wall.
struct GuideRoom {
    const char *name = "";
    std::string light{};                       ///< and what else stands in the room
    std::string floor = "Material 'diffuse'";  ///< its material
    std::string walls = "Material 'diffuse' 'rgb reflectance' [ .6 .5 .4 ]";
    std::string parameters{};  ///< of the integrator
    bool fog = false;          ///< the room is full of it, and the integrator is volpath
    bool window = false;       ///< the back wall has a hole
    int size = 48;             ///< of the film, in pixels
    std::string sampler = "independent";
};
std::string GuideRoomText(const GuideRoom &room);

/// A lamp that lights a part of the ceiling, from where all other light comes.
extern const std::string kSpotAtCeiling;
/// A lamp that both light sampling and bounces find, beside a wall that hides it from a part of the room.
extern const std::string kPanelBehindCurtain;

/// What guides the paths of a scene, or null.
inline const ext::PathGuide *GuideOf(const BuiltScene &built) {
    return dynamic_cast<const ext::PathGuide *>(built.integrator->Directions());
}

}  // namespace pbrt::test
