#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

enum class AttributeTarget { Shape, Light, Material, Medium, Texture };
inline constexpr size_t AttributeTargetCount = 5;

/// An AreaLightSource directive, added to the description when the first shape uses it.
struct PendingAreaLight {
    Entity entity;
    int index = -1;
    bool warnedInObject = false;
};

/// State saved by AttributeBegin and restored by AttributeEnd (pbrt-v4-format §2.1).
struct GraphicsState {
    TransformPair ctm;
    bool startActive = true, endActive = true;
    Float startTime = 0, endTime = 1;
    bool reverseOrientation = false;
    MaterialRef material;
    std::shared_ptr<PendingAreaLight> areaLight;
    std::string insideMedium, outsideMedium;
    std::string colorSpace = "srgb";
    /// Parameters of Attribute directives, one list per target. Copy-on-write: scopes may share a list, and only its
    /// sole owner may append (files are read by one thread).
    std::array<std::shared_ptr<std::vector<Param>>, AttributeTargetCount> attributes;
};

}  // namespace pbrt
