#pragma once
#include <map>
#include <utility>
#include <vector>

#include "pbrt/build/collect.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/progress.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/lights/light_names.h"
#include "pbrt/materials/material_factory.h"
#include "pbrt/scene/scene.h"
#include "pbrt/shapes/curves.h"
#include "pbrt/shapes/extent.h"
#include "pbrt/shapes/shape_factory.h"
#include "pbrt/shapes/triangle_mesh.h"

namespace pbrt {

/// Texture parameters of a shape. Read here because pbrt/shapes must not depend on pbrt/textures.
struct ShapeTextureParams {
    bool isDisplaceable = true;
    FloatTextureParam alpha{}, displacement{};
    void Describe(auto &&v) {
        v("alpha", alpha, "fraction of rays that the surface stops");
        if (isDisplaceable) v("displacement", displacement, "displacement along normals; needs normals and uv");
    }
};

/// ShapeTraits::isDisplaceable; false for unknown shapes.
inline bool IsDisplaceable(const std::string &shape) {
    return Shapes().Has(shape) && Shapes().Find(shape).traits.isDisplaceable;
}

/// Builds materials, shapes, area lights, objects and instances. Errors are collected in the sink.
class GeometryBuilder {
  public:
    /// `eye`: Placement::eye. `interfacesBlock`: interface surfaces block shadow rays. `media`: named by shapes.
    GeometryBuilder(SceneDescription &description, const Transform &renderFromWorld, const Point3 &eye,
                    bool interfacesBlock, const BuiltMedia &media, TextureLibrary &textures, DiagnosticSink &sink)
        : description_(description), renderFromWorld_(renderFromWorld), eyeFromWorld_(Transform::Translate(-eye)),
          interfacesBlock_(interfacesBlock), media_(media), textures_(textures), sink_(sink) {
        contents_.accel = std::make_unique<Accel>();
        contents_.lights = std::make_unique<LightTable>();
        work_.reserve(description_.shapes.size());
        auto add = [&](ShapeEntity &entity, int object) {
            Work &w = work_.emplace_back();
            w.entity = &entity;
            w.object = object;
        };
        for (ShapeEntity &s : description_.shapes) add(s, -1);
        for (size_t o = 0; o < description_.objects.size(); ++o)
            for (ShapeEntity &s : description_.objects[o].shapes) add(s, int(o));
        for (const ObjectEntity &o : description_.objects)
            spaces_.push_back(o.shapes.empty() ? Transform()
                                               : Transform::Translate(Vector3(o.shapes.front().ctm.start.Matrix()[3])));
    }

    void BuildMaterials() {
        auto forced = [&](MaterialPtr m) {
            return description_.options.forceDiffuse.value_or(false) ? ForceDiffuse(std::move(m)) : m;
        };
        auto byName = [&](const std::string &name) -> MaterialPtr {
            auto it = named_.find(name);
            return it == named_.end() || !it->second ? nullptr : contents_.materials[it->second.value];
        };
        MaterialContext context{textures_, description_.files, sink_, byName};
        const std::vector<MaterialEntity> &all = description_.materials;
        contents_.materials.resize(all.size() + 1);
        byIndex_.resize(all.size());
        // Mixes without a name are last, as in stock: only they may use materials that are defined later.
        for (const bool isLast : {false, true})
            for (size_t i = 0; i < all.size(); ++i) {
                const MaterialEntity &m = all[i];
                if ((m.name.empty() && m.type == "mix") != isLast) continue;
                Collect(sink_, [&] {
                    contents_.materials[i] = forced(MakeMaterial(m.type, m.params, context));
                    byIndex_[i] = MaterialId(i);
                });
                if (!m.name.empty()) named_.emplace(m.name, byIndex_[i]);
            }
        contents_.materials.back() = forced(MakeMaterial("diffuse", ParamSet("Material \"diffuse\"", {}), context));
        defaultMaterial_ = MaterialId(all.size());
    }
    /// Reads and transforms all shapes (in parallel), then registers them in file order.
    void BuildShapes(Progress &progress) {
        // Single-threaded, because the texture library is not thread-safe.
        for (Work &w : work_) {
            Collect(w.sink, [&] {
                ShapeTextureParams p{IsDisplaceable(w.entity->type)};
                ParamReader reader(w.entity->params);
                p.Describe(reader);
                reader.ThrowIfErrors();
                w.alpha = textures_.Get(p.alpha);
                if (w.alpha && w.alpha->Constant() && *w.alpha->Constant() >= 1) w.alpha = nullptr;
                if (FloatTexturePtr height = textures_.Get(p.displacement)) w.displacement = MakeDisplacement(height);
            });
        }
        ParallelForEach(int64_t(work_.size()), [&](int64_t i) {
            Work &w = work_[i];
            MakeShapes(w);
            if (w.object < 0) w.entity->params = {};  // frees large inline meshes
            progress.Advance();
        });
        CenterDefinitions();
        MergeCurves();
        std::vector<Definition> definitions(description_.objects.size());
        for (Work &w : work_) {
            sink_.Add(w.sink);
            Register(w, w.object >= 0 ? &definitions[w.object] : nullptr);
        }
        BuildInstances(definitions);
        work_.clear();
    }
    int64_t ShapeEntityCount() const { return int64_t(work_.size()); }
    /// Moves out the contents. The Accel is not committed and the lights are not finished.
    SceneContents TakeContents() { return std::move(contents_); }
    LightNames TakeLightNames() { return std::move(lightNames_); }
    /// Of the surfaces that do not emit, in rendering space.
    const Bounds3 &Receivers() const { return receivers_; }

  private:
    /// A Shape directive in progress.
    struct Work {
        ShapeEntity *entity = nullptr;
        int object = -1;  ///< index into description.objects, -1: the scene itself
        FloatTexturePtr alpha;
        std::optional<Displacement> displacement;
        /// In rendering space, in the space of their object definition, or in their own if they move.
        std::vector<std::unique_ptr<Shape>> shapes;
        Bounds3 bounds;                                   ///< of the shapes
        std::unique_ptr<const AnimatedTransform> motion;  ///< null: static
        DiagnosticSink sink;
    };

    /// An object definition, as objects of Accel.
    struct Definition {
        std::vector<ShapeId> still;  ///< in spaces_
        struct Moving {
            int object;
            AnimatedTransform eyeFromObject;
            Bounds3 bounds;  ///< at both ends of the motion
        };
        std::vector<Moving> moving;
    };

    Displacement MakeDisplacement(const FloatTexturePtr &height) const {
        return {[height](const Point3 &p, const Normal3 &n, const Point2 &uv) {
                    TextureContext ctx;
                    ctx.p = p;
                    ctx.n = n;
                    ctx.uv = uv;
                    return height->Evaluate(ctx);
                },
                description_.options.displacementEdgeScale.value_or(1)};
    }
    void MakeShapes(Work &w) {
        const ShapeEntity &e = *w.entity;
        Collect(w.sink, [&] {
            Transform place = Product({renderFromWorld_, e.ctm.start}), renderFromPlaced;
            if (e.ctm.IsAnimated()) {
                const Transform &fromWorld = w.object >= 0 ? eyeFromWorld_ : renderFromWorld_;
                w.motion = std::make_unique<const AnimatedTransform>(
                    MotionOf("the shape", e, Product({fromWorld, e.ctm.start}), Product({fromWorld, e.ctm.end})));
                renderFromPlaced = std::exchange(place, Transform());
            } else if (w.object >= 0) {
                const Transform &space = spaces_[w.object];
                place = Product({space.Inverse(), e.ctm.start});
                renderFromPlaced = Product({renderFromWorld_, space});
            }
            // A constant alpha of 0 makes a light that emits as if opaque.
            const bool opaque = !w.alpha || w.alpha->Constant() == Float(0);
            ParamReader before(e.params);
            ShapeTextureParams{IsDisplaceable(e.type)}.Describe(before);  // already read
            const ShapeContext context{place,
                                       e.reverseOrientation,
                                       description_.files,
                                       w.sink,
                                       before,
                                       w.displacement ? &*w.displacement : nullptr,
                                       opaque,
                                       renderFromPlaced};
            w.shapes = Shapes().Make(e.type, e.params, context);
            w.bounds = {};
            for (const auto &shape : w.shapes) {
                w.bounds = Union(w.bounds, BoundsOf(*shape));
                auto *mesh = dynamic_cast<Mesh *>(shape.get());
                if (mesh && w.object < 0 && !w.motion) mesh->TraceLargePlanesInDouble();
            }
            if (w.motion)
                for (const auto &shape : w.shapes) RequireReach(e.params.What(), *w.motion, BoundsOf(*shape), e.loc);
        });
    }
    /// Rebuilds shapes of object definitions with vertices far from their space's origin, for the precision of rays.
    void CenterDefinitions() {
        constexpr Float kFar = 64;  ///< relative to the size, from the origin
        std::vector<Bounds3> bounds(spaces_.size());
        for (const Work &w : work_)
            if (w.object >= 0 && !w.motion) bounds[w.object] = Union(bounds[w.object], w.bounds);
        auto isFar = [](const Bounds3 &b) {
            return !b.IsEmpty() && MaxComponent(Abs(b.low + b.high) / Float(2)) > kFar * MaxComponent(b.high - b.low);
        };
        for (size_t o = 0; o < spaces_.size(); ++o)
            if (isFar(bounds[o]))
                spaces_[o] = Product({spaces_[o], Transform::Translate((bounds[o].low + bounds[o].high) / Float(2))});
        ParallelForEach(int64_t(work_.size()), [&](int64_t i) {
            Work &w = work_[i];
            if (w.object < 0) return;
            if (isFar(bounds[w.object]) && !w.motion && !w.shapes.empty()) {
                DiagnosticSink reported = std::move(w.sink);
                MakeShapes(w);
                w.sink = std::move(reported);
            }
            w.entity->params = {};
        });
    }
    /// None if the name is not defined, which the parser reports.
    MaterialId ResolveMaterial(const ShapeEntity &entity) const {
        const MaterialRef &ref = entity.material;
        if (ref.index >= 0) return byIndex_[ref.index];
        if (ref.name.empty()) return defaultMaterial_;
        const auto it = named_.find(ref.name);
        return it == named_.end() ? MaterialId() : it->second;
    }
    /// Merges consecutive curves that differ only in geometry: scenes have one Shape directive per hair.
    void MergeCurves() {
        Work *previous = nullptr;
        for (Work &w : work_) {
            if (w.shapes.size() != 1 || w.shapes[0]->Kind() != ShapeKind::Curves || w.alpha ||
                w.entity->areaLight >= 0) {
                previous = nullptr;
                continue;
            }
            const ShapeEntity &e = *w.entity;
            if (previous) {
                const ShapeEntity &p = *previous->entity;
                if (previous->object == w.object && p.material.index == e.material.index &&
                    p.material.name == e.material.name && p.insideMedium == e.insideMedium &&
                    p.outsideMedium == e.outsideMedium &&
                    (p.ctm == e.ctm || !(p.ctm.IsAnimated() || e.ctm.IsAnimated())) &&
                    static_cast<Curves &>(*previous->shapes[0]).Append(static_cast<const Curves &>(*w.shapes[0]))) {
                    w.shapes.clear();
                    continue;
                }
            }
            previous = &w;
        }
    }
    /// Maker of the shape's area light; null if it does not emit.
    const AreaLightMaker *MakerFor(const ShapeEntity &e, bool isInterface, bool isInDefinition) {
        if (e.areaLight < 0) return nullptr;
        if (isInterface || isInDefinition) {
            sink_.Warning(e.loc, isInterface
                                     ? "the area light on a surface with material \"interface\" is ignored."
                                     : "area lights inside object definitions are not supported; this one is ignored.");
            return nullptr;
        }
        const auto [it, isNew] = makers_.try_emplace(e.areaLight);
        std::optional<AreaLightMaker> &maker = it->second;
        if (isNew)
            Collect(sink_, [&] {
                const Entity &light = description_.areaLights[e.areaLight];
                const Transform none;
                maker.emplace(AreaLights().Make(light.type, light.params,
                                                LightContext{none, none, SpaceOf(light), description_.files, sink_}));
            });
        return maker ? &*maker : nullptr;
    }
    /// `definition`: null outside object definitions.
    void Register(Work &w, Definition *definition) {
        const ShapeEntity &e = *w.entity;
        MaterialId material = ResolveMaterial(e);
        bool interface =
            material && contents_.materials[material.value] && contents_.materials[material.value]->IsInterface();
        const AreaLightMaker *maker = MakerFor(e, interface, definition);
        std::vector<ShapeId> moving;
        // One light for all shapes of the directive: a PLY of triangles and quads has two.
        LightId firstLight;
        if (maker) {
            std::vector<const Shape *> shapes;
            for (const std::unique_ptr<Shape> &shape : w.shapes)
                if (shape->PrimitiveCount() > 0) shapes.push_back(shape.get());
            if (!shapes.empty()) {
                firstLight = contents_.lights->Add((*maker)(shapes, w.alpha.get()));
                contents_.lightMedia.push_back({media_.Find(e.outsideMedium), media_.Find(e.insideMedium)});
            }
        }
        if (!firstLight && !definition) AddReceiver(w.motion.get(), w.bounds);
        uint32_t emitters = 0;
        const char *primitive = w.shapes.empty() ? "" : kPrimitiveNames[size_t(w.shapes.front()->Kind())];
        if (w.shapes.size() > 1) primitive = "face";
        for (std::unique_ptr<Shape> &shape : w.shapes) {
            const ShapeId id(contents_.shapes.size());
            contents_.shapes.push_back(
                {std::move(shape), w.alpha, material, {}, media_.Find(e.insideMedium), media_.Find(e.outsideMedium)});
            ShapeRecord &record = contents_.shapes.back();
            if (firstLight) {
                record.firstLight = LightId(firstLight.value + emitters);
                emitters += record.shape->PrimitiveCount();
            }
            if (interface && !interfacesBlock_)
                contents_.accel->LetShadowRaysThrough(id, record.insideMedium != record.outsideMedium);
            if (w.motion) moving.push_back(id);
            else if (definition) definition->still.push_back(id);
            else contents_.accel->AddShape(id, *record.shape, record.alpha.get());
        }
        if (maker) {
            const Entity &light = description_.areaLights[e.areaLight];
            lightNames_.Add(emitters, fmt::format("AreaLightSource \"{}\"", light.type), light.loc, e.loc, primitive);
        }
        if (moving.empty()) return;
        const int object = AddAccelObject(moving, Product({renderFromWorld_, e.ctm.start}));
        if (definition) {
            Bounds3 bounds;
            for (ShapeId id : moving)
                for (const Transform &t : {w.motion->Start(), w.motion->At(w.motion->EndTime())})
                    bounds = Union(bounds, TransformBounds(t, BoundsOf(*contents_.shapes[id.value].shape)));
            definition->moving.push_back({object, *w.motion, bounds});
        } else {
            contents_.accel->AddMovingInstance(object, *w.motion);
        }
    }
    /// `place`: null: none.
    void AddReceiver(const AnimatedTransform *place, const Bounds3 &bounds) {
        if (bounds.IsEmpty()) return;
        if (!place) receivers_ = Union(receivers_, bounds);
        else
            for (const Transform &t : {place->Start(), place->At(place->EndTime())})
                receivers_ = Union(receivers_, TransformBounds(t, bounds));
    }
    int AddAccelObject(const std::vector<ShapeId> &ids, const Transform &renderFromObject = {}) {
        std::vector<const Shape *> shapes;
        std::vector<const FloatTexture *> alphas;
        for (ShapeId id : ids) {
            shapes.push_back(contents_.shapes[id.value].shape.get());
            alphas.push_back(contents_.shapes[id.value].alpha.get());
        }
        return contents_.accel->AddObject(ids, shapes, alphas, renderFromObject);
    }
    void BuildInstances(const std::vector<Definition> &definitions) {
        struct Placeable {
            const Definition *definition;
            int still;       ///< accel object, -1: none
            Bounds3 bounds;  ///< of all its shapes
            const Transform *space;
        };
        std::map<std::string, Placeable> byName;
        for (size_t o = 0; o < definitions.size(); ++o) {
            const Definition &d = definitions[o];
            Bounds3 bounds;
            const Transform place = Product({eyeFromWorld_, spaces_[o]});
            for (ShapeId id : d.still)
                bounds = Union(bounds, TransformBounds(place, BoundsOf(*contents_.shapes[id.value].shape)));
            for (const Definition::Moving &m : d.moving) bounds = Union(bounds, m.bounds);
            const int still = d.still.empty() ? -1 : AddAccelObject(d.still, Product({renderFromWorld_, spaces_[o]}));
            byName[description_.objects[o].name] = {&d, still, bounds, &spaces_[o]};
        }
        // Motions turn about the camera, as in stock's default rendering space, and so are the same in all.
        const Transform worldFromEye = eyeFromWorld_.Inverse();
        for (const InstanceEntity &i : description_.instances) {
            auto it = byName.find(i.name);
            if (it == byName.end()) continue;
            Collect(sink_, [&] {
                const AnimatedTransform motion =
                    MotionOf("the instance", i, Product({renderFromWorld_, i.ctm.start, worldFromEye}),
                             Product({renderFromWorld_, i.ctm.end, worldFromEye}));
                RequireReach(fmt::format("the instance of \"{}\"", Abbreviate(i.name)), motion, it->second.bounds,
                             i.loc);
                if (motion.Start().IsSingular()) {  // hides an object, as in stock
                    sink_.Warning(i.loc,
                                  "the instance of \"{}\" cannot be seen: the current transformation flattens it.",
                                  Abbreviate(i.name));
                    return;
                }
                AddReceiver(&motion, it->second.bounds);
                if (it->second.still >= 0) {
                    const Transform &space = *it->second.space;
                    if (motion.IsAnimated())
                        contents_.accel->AddMovingInstance(it->second.still, motion, Product({eyeFromWorld_, space}));
                    else
                        contents_.accel->AddInstance(it->second.still, Product({renderFromWorld_, i.ctm.start, space}));
                }
                for (const Definition::Moving &m : it->second.definition->moving)
                    contents_.accel->AddMovingInstance(m.object, motion, m.eyeFromObject);
            });
        }
    }

    /// Primitives of the kinds of shapes, in the order of ShapeKind.
    static constexpr const char *kPrimitiveNames[] = {"triangle", "patch", "sphere", "disk", "cylinder", "curve"};

    SceneDescription &description_;
    Transform renderFromWorld_;
    Transform eyeFromWorld_;  ///< to the space in which object definitions and their motions lie
    bool interfacesBlock_;
    const BuiltMedia &media_;
    TextureLibrary &textures_;
    DiagnosticSink &sink_;
    SceneContents contents_;
    LightNames lightNames_;
    Bounds3 receivers_;
    std::vector<Work> work_;
    /// By object definition: world from the space of its static shapes, a translation that centres them.
    std::vector<Transform> spaces_;
    std::map<std::string, MaterialId> named_;
    std::vector<MaterialId> byIndex_;
    MaterialId defaultMaterial_{};
    std::map<int, std::optional<AreaLightMaker>> makers_;  ///< by area-light entity; empty after an error
};

}  // namespace pbrt
