#pragma once
#include <map>
#include <vector>

#include "pbrt/build/medium_builder.h"
#include "pbrt/core/progress.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/lights/light_names.h"
#include "pbrt/materials/material_factory.h"
#include "pbrt/scene/scene.h"
#include "pbrt/scenefile/scene_description.h"
#include "pbrt/shapes/displacement.h"

namespace pbrt {

/// Documents all shapes with their parameters, including those that name textures.
FamilyDoc DocumentShapes();

/// Materials, shapes, area lights, objects and instances of a description. Mistakes are collected in the sink.
class GeometryBuilder {
  public:
    /// `interfacesBlock`: interface surfaces stop shadow rays. `media`: the media that shapes name.
    GeometryBuilder(SceneDescription &description, const Transform &renderFromWorld, bool interfacesBlock,
                    const MediumIds &media, TextureLibrary &textures, DiagnosticSink &sink);

    void BuildMaterials();
    /// Reads and transforms all shapes (in parallel), then registers them in file order.
    void BuildShapes(Progress &progress);
    int64_t ShapeEntityCount() const { return static_cast<int64_t>(work_.size()); }
    /// The parts built so far. The Accel is not committed and the lights are not finished.
    SceneContents TakeContents() { return std::move(contents_); }
    /// The names of all lights in the contents.
    LightNames TakeLightNames() { return std::move(lightNames_); }

  private:
    /// One Shape directive on its way to becoming shapes.
    struct Work {
        ShapeEntity *entity = nullptr;
        int object = -1;  ///< index into description.objects, -1: the scene itself
        FloatTexturePtr alpha;
        std::optional<Displacement> displacement;
        /// In rendering space, in the space of their object definition, or in their own if they move.
        std::vector<std::unique_ptr<Shape>> shapes;
        std::unique_ptr<const AnimatedTransform> motion;  ///< null: they do not move
        DiagnosticSink sink;
    };

    /// An object definition in terms of Accel's objects.
    struct Definition {
        std::vector<ShapeId> still;  ///< in spaces_
        struct Moving {
            int object;
            AnimatedTransform renderFromObject;
            Bounds3 bounds;  ///< at the start and the end of the motion
        };
        std::vector<Moving> moving;
    };

    void MakeShapes(Work &work);
    /// Makes shapes of object definitions again whose vertices lie far from the origin of their space: there, rays have
    /// few digits.
    void CenterDefinitions();
    MaterialId ResolveMaterial(const ShapeEntity &entity);
    /// Scenes have one Shape directive per hair: consecutive curves that differ only in their geometry become one
    /// shape.
    void MergeCurves();
    /// The maker of the shape's area light; null if the shape is not an emitter.
    const AreaLightMaker *MakerFor(const ShapeEntity &entity, bool isInterface, bool isInDefinition);
    /// `definition`: null outside object definitions.
    void Register(Work &work, Definition *definition);
    int AddAccelObject(const std::vector<ShapeId> &shapes, const Transform &renderFromObject = {});
    void BuildInstances(const std::vector<Definition> &definitions);

    SceneDescription &description_;
    Transform renderFromWorld_;
    bool interfacesBlock_;
    const MediumIds &media_;
    TextureLibrary &textures_;
    DiagnosticSink &sink_;
    SceneContents contents_;
    LightNames lightNames_;
    std::vector<Work> work_;
    /// By object definition: world from the space of its still shapes, a translation that brings them to the origin.
    std::vector<Transform> spaces_;
    std::map<std::string, MaterialId> named_;
    std::vector<MaterialId> byIndex_;
    MaterialId defaultMaterial_{};
    std::vector<AreaLightMaker> makers_;  ///< by area-light index
    std::vector<int> makerOf_;            ///< area-light entity -> makers_ index, -1 not made, -2 failed
};

}  // namespace pbrt
