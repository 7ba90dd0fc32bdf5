#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pbrt/core/files.h"
#include "pbrt/core/params.h"
#include "pbrt/math/transform.h"

namespace pbrt {

/// Start and end CTM, at the TransformTimes.
struct TransformPair {
    Transform start, end;
    bool IsAnimated() const { return !(start == end); }
    bool operator==(const TransformPair &) const = default;
};

/// Material by index or name; default: diffuse with reflectance 0.5.
struct MaterialRef {
    int index = -1;
    std::string name;
};

/// State at a directive that applies to shapes.
struct ShapeState {
    TransformPair ctm;
    Float startTime = 0, endTime = 1;
    bool reverseOrientation = false;
    MaterialRef material;
    std::string insideMedium, outsideMedium;
};

struct Entity {
    std::string type;
    ParamSet params;
    FileLoc loc;
    std::string colorSpace = "srgb";  ///< current at the directive
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

struct ShapeEntity : Entity, ShapeState {
    int areaLight = -1;  ///< index into areaLights, -1: none
};

/// An object definition; its shapes are in world space under the CTM of the definition.
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

/// Values of Option directives; unset ones are left to the command line.
struct SceneOptions {
    std::optional<bool> disablePixelJitter, disableTextureFiltering, disableWavelengthJitter, forceDiffuse, pixelStats,
        wavefront;
    std::optional<Float> displacementEdgeScale;
    std::optional<std::string> mseReferenceImage, mseReferenceOut, renderCoordSys;
    FileLoc mseReferenceLoc;  ///< of the last Option that names one of these files
    std::optional<int> seed;
};

/// Content of a scene in file order, as plain data.
struct SceneDescription {
    SceneOptions options;
    Entity film, sampler, filter, integrator, accelerator;  ///< defaults if absent (§5)
    CameraEntity camera;
    std::vector<MaterialEntity> materials;  ///< unnamed and named, in file order
    std::vector<TextureEntity> textures;
    std::vector<MediumEntity> media;
    std::vector<LightEntity> lights;
    std::vector<Entity> areaLights;
    std::vector<ShapeEntity> shapes;
    std::vector<ObjectEntity> objects;
    std::vector<InstanceEntity> instances;
    /// Directives to be checked only. By directive: replaced options. By target of Attribute: one entity without type,
    /// which has the parameters of all such directives without their values.
    std::map<std::string, std::vector<Entity>> unbuilt;
    FileResolver files;
    std::vector<std::string> sources;  ///< scene files, also included ones; "-": standard input
};

/// Calls f for the shapes of the scene, then for those of its objects.
void ForEachShape(auto &scene, auto &&f) {
    for (auto &shape : scene.shapes) f(shape);
    for (auto &object : scene.objects)
        for (auto &shape : object.shapes) f(shape);
}

}  // namespace pbrt
