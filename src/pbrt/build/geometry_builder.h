#pragma once
#include <map>
#include <vector>

#include "pbrt/core/progress.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/materials/material_factory.h"
#include "pbrt/scene/scene.h"
#include "pbrt/scenefile/scene_description.h"

namespace pbrt {

/// Materials, shapes, area lights, objects and instances of a description. Mistakes are collected in the sink.
class GeometryBuilder {
  public:
    GeometryBuilder(SceneDescription &description, const Transform &renderFromWorld, TextureLibrary &textures, DiagnosticSink &sink);

    void BuildMaterials();
    /// Reads and transforms all shapes (in parallel), then registers them in file order.
    void BuildShapes(Progress &progress);
    int64_t ShapeEntityCount() const { return static_cast<int64_t>(work_.size()); }
    /// Accel not committed, lights not finished.
    SceneParts TakeParts() { return std::move(parts_); }

  private:
    /// One Shape directive on its way to becoming shapes.
    struct Work {
        ShapeEntity *entity = nullptr;
        int object = -1;  ///< index into description.objects, -1: the scene itself
        FloatTexturePtr alpha;
        std::vector<std::unique_ptr<Shape>> shapes;
        DiagnosticSink sink;
    };

    MaterialId ResolveMaterial(const ShapeEntity &entity);
    /// Curves come as one directive per hair: neighbours that differ in nothing else become one shape.
    void MergeCurves();
    void Register(Work &work, std::vector<ShapeId> *object);
    void BuildInstances(const std::vector<std::vector<ShapeId>> &objects);

    SceneDescription &description_;
    Transform renderFromWorld_;
    TextureLibrary &textures_;
    DiagnosticSink &sink_;
    SceneParts parts_;
    std::vector<Work> work_;
    std::map<std::string, MaterialId> named_;
    std::vector<MaterialId> byIndex_;
    MaterialId defaultMaterial_{};
    std::vector<AreaLightMaker> makers_;  ///< by area-light index
    std::vector<int> makerOf_;                  ///< area-light entity -> makers_ index, -1 not made, -2 failed
};

}  // namespace pbrt
