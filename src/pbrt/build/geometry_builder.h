#pragma once
#include <map>
#include <vector>

#include "pbrt/core/progress.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/lights/light_names.h"
#include "pbrt/materials/material_factory.h"
#include "pbrt/scene/scene.h"
#include "pbrt/scenefile/scene_description.h"
#include "pbrt/shapes/mesh_sources.h"

namespace pbrt {

FamilyDoc DocumentShapes();

struct BuiltMedia {
    std::vector<std::unique_ptr<Medium>> media;  ///< by MediumId
    std::map<std::string, MediumId> ids;

    /// No medium for "" (vacuum) and for media that failed to build.
    MediumId Find(const std::string &name) const {
        auto it = ids.find(name);
        return it == ids.end() ? MediumId() : it->second;
    }
};

/// Builds all media of the scene, including unused ones, so that all errors are reported to the sink. Frees value lists
/// of the description.
BuiltMedia MakeMedia(SceneDescription &description, const Transform &renderFromWorld, DiagnosticSink &sink);

/// Builds materials, shapes, area lights, objects and instances. Errors are collected in the sink.
class GeometryBuilder {
  public:
    /// `interfacesBlock`: interface surfaces block shadow rays. `media`: named by shapes.
    GeometryBuilder(SceneDescription &description, const Transform &renderFromWorld, bool interfacesBlock,
                    const BuiltMedia &media, TextureLibrary &textures, DiagnosticSink &sink);

    void BuildMaterials();
    /// Reads and transforms all shapes (in parallel), then registers them in file order.
    void BuildShapes(Progress &progress);
    int64_t ShapeEntityCount() const { return int64_t(work_.size()); }
    /// Moves out the contents. The Accel is not committed and the lights are not finished.
    SceneContents TakeContents() { return std::move(contents_); }
    LightNames TakeLightNames() { return std::move(lightNames_); }

  private:
    /// A Shape directive in progress.
    struct Work {
        ShapeEntity *entity = nullptr;
        int object = -1;  ///< index into description.objects, -1: the scene itself
        FloatTexturePtr alpha;
        std::optional<Displacement> displacement;
        /// In rendering space, in the space of their object definition, or in their own if they move.
        std::vector<std::unique_ptr<Shape>> shapes;
        std::unique_ptr<const AnimatedTransform> motion;  ///< null: static
        DiagnosticSink sink;
    };

    /// An object definition, as objects of Accel.
    struct Definition {
        std::vector<ShapeId> still;  ///< in spaces_
        struct Moving {
            int object;
            AnimatedTransform renderFromObject;
            Bounds3 bounds;  ///< at both ends of the motion
        };
        std::vector<Moving> moving;
    };

    void MakeShapes(Work &work);
    /// Rebuilds shapes of object definitions whose vertices are far from their space's origin, where rays lose
    /// precision.
    void CenterDefinitions();
    /// None if the name is not defined, which the parser reports.
    MaterialId ResolveMaterial(const ShapeEntity &entity) const;
    /// Merges consecutive curves that differ only in geometry: scenes have one Shape directive per hair.
    void MergeCurves();
    /// Maker of the shape's area light; null if it does not emit.
    const AreaLightMaker *MakerFor(const ShapeEntity &entity, bool isInterface, bool isInDefinition);
    /// `definition`: null outside object definitions.
    void Register(Work &work, Definition *definition);
    int AddAccelObject(const std::vector<ShapeId> &shapes, const Transform &renderFromObject = {});
    void BuildInstances(const std::vector<Definition> &definitions);

    SceneDescription &description_;
    Transform renderFromWorld_;
    bool interfacesBlock_;
    const BuiltMedia &media_;
    TextureLibrary &textures_;
    DiagnosticSink &sink_;
    SceneContents contents_;
    LightNames lightNames_;
    std::vector<Work> work_;
    /// By object definition: world from the space of its static shapes, a translation that centres them.
    std::vector<Transform> spaces_;
    std::map<std::string, MaterialId> named_;
    std::vector<MaterialId> byIndex_;
    MaterialId defaultMaterial_{};
    std::map<int, std::optional<AreaLightMaker>> makers_;  ///< by area-light entity; empty after an error
};

}  // namespace pbrt
