#pragma once
#include <string>
#include <vector>

namespace pbrt::test {

/// Where the camera and the receivers are.
enum class Place { Around, Within };

/// One kind of area light: as in a scene file.
struct EmitterKind {
    std::string name;
    std::string text;
    Place place = Place::Around;
    bool isMesh = false;  ///< of several primitives, which "meshlights" groups
    bool isSeen = true;   ///< false: rays pass it (alpha of 0)
};

/// Every shape, whole and in part, plain, reversed, mirrored, scaled, stretched, one-sided and two-sided, with alpha,
/// with holes, with an image, seen from outside and from inside.
std::vector<EmitterKind> EmitterKinds();

/// A scene with that emitter, a small lamp (the light with the first id) and diffuse receivers: 32 x 32 pixels, direct
/// light.
std::string EmitterScene(const EmitterKind &kind);

}  // namespace pbrt::test
