#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/core/params.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// The two CTMs (start and end of the shutter interval given by TransformTimes).
struct TransformPair {
    Transform start, end;
    bool IsAnimated() const { return !(start == end); }
    bool operator==(const TransformPair &) const = default;
};

/// Index into the description's material list, or a name. Without both it is the default, a diffuse material with
/// reflectance 0.5.
struct MaterialRef {
    int index = -1;
    std::string name;
};

/// A directive that makes one thing: type word and parameters.
struct Entity {
    std::string type;
    ParamSet params;
    FileLoc loc;
    std::string colorSpace = "srgb";  ///< in force at the directive
};

struct CameraEntity : Entity {
    TransformPair cameraFromWorld;
    Float startTime = 0, endTime = 1;
    std::string medium;
};

struct MaterialEntity : Entity {
    std::string name;  ///< empty for Material
};

struct TextureEntity : Entity {
    std::string name;
    bool isSpectrum = false;
    TransformPair ctm;
};

struct MediumEntity : Entity {
    std::string name;
    TransformPair ctm;
};

struct LightEntity : Entity {
    TransformPair ctm;
    std::string medium;
};

struct ShapeEntity : Entity {
    TransformPair ctm;
    Float startTime = 0, endTime = 1;
    bool reverseOrientation = false;
    MaterialRef material;
    int areaLight = -1;  ///< index into areaLights, -1: none
    std::string insideMedium, outsideMedium;
};

/// An object definition: its shapes lie in world space under the CTM of the definition.
struct ObjectEntity {
    std::string name;
    FileLoc loc;
    std::vector<ShapeEntity> shapes;
};

struct InstanceEntity {
    std::string name;
    FileLoc loc;
    TransformPair ctm;
    Float startTime = 0, endTime = 1;
};

/// Values of Option directives; options that are not set leave the choice to the command line.
struct SceneOptions {
    std::optional<bool> disablePixelJitter, disableTextureFiltering, disableWavelengthJitter, forceDiffuse, pixelStats,
        wavefront;
    std::optional<Float> displacementEdgeScale;
    std::optional<std::string> mseReferenceImage, mseReferenceOut, renderCoordSys;
    std::optional<int> seed;
};

/// The content of a scene file in its order, as plain data: nothing is built yet.
struct SceneDescription {
    SceneOptions options;
    Entity film, sampler, filter, integrator, accelerator;  ///< defaults filled in when absent (§5)
    CameraEntity camera;
    std::vector<MaterialEntity> materials;  ///< unnamed and named, in file order
    std::vector<TextureEntity> textures;
    std::vector<MediumEntity> media;
    std::vector<LightEntity> lights;
    std::vector<Entity> areaLights;
    std::vector<ShapeEntity> shapes;
    std::vector<ObjectEntity> objects;
    std::vector<InstanceEntity> instances;
    FileResolver files;
};

}  // namespace pbrt
