#include "pbrt/accel/accel.h"

#include <atomic>
#include <map>

#include "pbrt/accel/embree_callbacks.h"
#include "pbrt/core/memory.h"
#include "pbrt/shapes/bilinear_mesh.h"

namespace pbrt {
namespace {

/// Embree's bound on coordinates of vertices, ray origins and directions (FLT_LARGE).
constexpr Float kEmbreeReach = 1.844e18f;

bool CountMemory(void *counter, ssize_t bytes, bool) {
    static_cast<std::atomic<int64_t> *>(counter)->fetch_add(bytes, std::memory_order_relaxed);
    return true;
}

RTCRay ToEmbree(const Ray &ray, Float time, Float tMin = 0) {
    // Embree accepts hits at tnear. Denormals may be flushed to zero.
    constexpr Float kSmallest = std::numeric_limits<Float>::min();
    const Float tNear = tMin < kSmallest ? kSmallest : NextFloat(tMin, true);
    constexpr unsigned kAllGeometries = 0xffffffffu;
    return {ray.o.x, ray.o.y, ray.o.z, tNear, ray.d.x, ray.d.y, ray.d.z, time, ray.tMax, kAllGeometries, 0, 0};
}

/// Numbers of time steps. Embree, like AnimatedTransform, interpolates rotations along great arcs, but scales as the
/// triangular factor of rotation * triangle. Motions that turn or shear are therefore sampled in steps: large motions
/// are off by at most a few thousandths of the object's size.
constexpr int kTurningSteps = 17, kTwofoldSteps = 65;

/// Rotation, triangular factor and translation of a non-singular affine matrix.
RTCQuaternionDecomposition Decompose(const glm::dmat4 &m) {
    glm::dmat3 axes(m), triangle(0);
    for (int c = 0; c < 3; ++c) {
        for (int k = 0; k < c; ++k) {
            triangle[c][k] = glm::dot(axes[k], axes[c]);
            axes[c] -= axes[k] * triangle[c][k];
        }
        triangle[c][c] = glm::length(axes[c]);
        axes[c] /= triangle[c][c];
    }
    if (glm::determinant(axes) < 0) {
        axes = -axes;
        triangle = -triangle;
    }
    const glm::quat q(glm::normalize(glm::quat_cast(axes)));
    const glm::mat3 s(triangle);
    RTCQuaternionDecomposition d;
    rtcInitQuaternionDecomposition(&d);
    rtcQuaternionDecompositionSetQuaternion(&d, q.w, q.x, q.y, q.z);
    rtcQuaternionDecompositionSetScale(&d, s[0][0], s[1][1], s[2][2]);
    rtcQuaternionDecompositionSetSkew(&d, s[1][0], s[2][0], s[2][1]);
    rtcQuaternionDecompositionSetTranslation(&d, Float(m[3].x), Float(m[3].y), Float(m[3].z));
    return d;
}

bool IsDiagonal(const Transform &t) {
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            if (r != c && t.Matrix()[c][r] != 0) return false;
    return true;
}

/// True if every patch can be an Embree quad: flat, with the same (u, v).
bool AllParallelograms(const BilinearMesh &mesh) {
    for (uint32_t i = 0; i < mesh.PrimitiveCount(); ++i)
        if (!mesh.IsParallelogram(i)) return false;
    return true;
}

}  // namespace

struct Accel::Impl {
    struct Group {
        RTCScene scene = nullptr;
        std::vector<std::unique_ptr<Geometry>> geometries;  ///< by Embree geometry id; null for instances
        std::vector<int32_t> instances;                     ///< by Embree geometry id; -1 for shapes
    };
    struct Motion {
        AnimatedTransform outer, inner;
        Transform At(Float time) const { return Product({outer.At(time), inner.At(time)}); }
        int StepCount() const {
            if (inner.IsAnimated()) return kTwofoldSteps;
            return outer.KeepsAxes() && IsDiagonal(inner.Start()) ? 2 : kTurningSteps;
        }
    };
    struct Instance {
        int object;
        Transform transform;               ///< if static
        std::unique_ptr<Motion> motion{};  ///< null: static
        RTCGeometry geometry = nullptr;    ///< owned by the Embree scene
    };

    std::atomic<int64_t> bytes{0};
    bool robust;
    RTCDevice device = nullptr;
    Group top;
    std::vector<Group> objects;
    std::vector<Instance> instances;
    std::map<uint32_t, ShadowRays> shadowless;  ///< shapes ignored by Occluded, by id
    bool anyMoves = false;
    Float startTime = 0, endTime = 1;  ///< of all moving instances
    bool committed = false;
    /// Largest origin and direction coordinates of rays that Embree can trace in every instance.
    Float maxOrigin = kEmbreeReach, maxDirection = kEmbreeReach;

    explicit Impl(bool isRobust) : robust(isRobust) {
        device = rtcNewDevice(nullptr);
        if (!device) {
            // Under a memory limit Embree, with its threads and tables, fails first.
            const RTCError error = rtcGetDeviceError(nullptr);
            if (error == RTC_ERROR_OUT_OF_MEMORY) throw UserError(OutOfMemoryText("building"));
            throw UserError(
                error == RTC_ERROR_UNSUPPORTED_CPU
                    ? std::string("Embree, which traces the rays, does not support this processor.")
                    : fmt::format("Embree, which traces the rays, cannot start (its error {}).", int(error)));
        }
        rtcSetDeviceMemoryMonitorFunction(device, CountMemory, &bytes);
        top.scene = NewScene();
    }
    ~Impl() {
        rtcReleaseScene(top.scene);
        for (Group &g : objects) rtcReleaseScene(g.scene);
        rtcReleaseDevice(device);
    }

    RTCScene NewScene() {
        RTCScene scene = rtcNewScene(device);
        if (!scene) CheckDevice();
        rtcSetSceneFlags(scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
        return scene;
    }

    RTCGeometry NewTriangles(const TriangleMesh &mesh) {
        const MeshData &data = mesh.Data();
        RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        ShareVertices(g, data);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, data.indices.data(), 0,
                                   3 * sizeof(uint32_t), mesh.PrimitiveCount());
        return g;
    }
    RTCGeometry NewQuads(const BilinearMesh &mesh) {
        const MeshData &data = mesh.Data();
        RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
        ShareVertices(g, data);
        auto *corners = static_cast<uint32_t *>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                                                                        4 * sizeof(uint32_t), mesh.PrimitiveCount()));
        if (!corners) CheckDevice();
        std::copy(data.indices.begin(), data.indices.end(), corners);
        // Embree orders corners around the quad.
        for (size_t i = 2; i < data.indices.size(); i += 4) std::swap(corners[i], corners[i + 1]);
        return g;
    }
    static void ShareVertices(RTCGeometry g, const MeshData &data) {
        PBRT_CHECK(data.p.capacity() > data.p.size());  // Embree reads 16 bytes from the last vertex
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, data.p.data(), 0, sizeof(Point3),
                                   data.p.size());
    }

    void Add(Group &group, ShapeId id, const Shape &shape, const FloatTexture *alpha,
             const Transform &renderFromShape = {}) {
        PBRT_CHECK(!committed);
        auto geometry = std::make_unique<Geometry>();
        geometry->shape = &shape;
        geometry->id = id;
        geometry->renderFromShape = renderFromShape;
        if (alpha) geometry->constantAlpha = alpha->Constant();
        if (geometry->constantAlpha && *geometry->constantAlpha <= 0) return;  // invisible
        if (!(geometry->constantAlpha && *geometry->constantAlpha >= 1)) geometry->alpha = alpha;
        if (shape.PrimitiveCount() == 0) return;

        const auto passing = shadowless.find(id.value);
        const ShadowCallbacks shadows =
            CallbacksFor(passing == shadowless.end() ? ShadowRays::Blocked : passing->second, geometry->alpha);
        RTCGeometry g = nullptr;
        const Mesh *mesh = Mesh::Of(shape);
        const bool isNative = mesh && !mesh->IsTracedInDouble();
        if (isNative && shape.Kind() == ShapeKind::TriangleMesh) {
            g = NewTriangles(static_cast<const TriangleMesh &>(shape));
            geometry->hitsOnce = true;
        } else if (isNative && shape.Kind() == ShapeKind::BilinearMesh &&
                   AllParallelograms(static_cast<const BilinearMesh &>(shape))) {
            g = NewQuads(static_cast<const BilinearMesh &>(shape));
            geometry->hitsOnce = true;
        } else {
            g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
            rtcSetGeometryUserPrimitiveCount(g, shape.PrimitiveCount());
            rtcSetGeometryBoundsFunction(g, UserBounds, nullptr);
            rtcSetGeometryIntersectFunction(g, UserIntersect);
            rtcSetGeometryOccludedFunction(g, shadows.userGeometry);
        }
        rtcSetGeometryUserData(g, geometry.get());
        if (geometry->hitsOnce) {
            if (geometry->alpha) rtcSetGeometryIntersectFilterFunction(g, AlphaFilter);
            if (shadows.filter) rtcSetGeometryOccludedFilterFunction(g, shadows.filter);
        }
        Attach(group, g, std::move(geometry), -1);
    }

    static void Attach(Group &group, RTCGeometry g, std::unique_ptr<Geometry> geometry, int32_t instance) {
        rtcCommitGeometry(g);
        unsigned int id = rtcAttachGeometry(group.scene, g);
        rtcReleaseGeometry(g);
        PBRT_CHECK(id == group.geometries.size());
        group.geometries.push_back(std::move(geometry));
        group.instances.push_back(instance);
    }

    /// Embree's time: [0, 1] over the motion.
    Float EmbreeTime(Float time) const {
        if (!anyMoves || time <= startTime) return 0;
        return time >= endTime ? 1 : (time - startTime) / (endTime - startTime);
    }
    void Place(const Instance &instance) {
        if (!instance.motion) {
            rtcSetGeometryTimeStepCount(instance.geometry, 1);
            rtcSetGeometryTransform(instance.geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR,
                                    &instance.transform.Matrix()[0][0]);
            NarrowReach(instance.transform);
            return;
        }
        const Motion &motion = *instance.motion;
        const int steps = motion.StepCount();
        rtcSetGeometryTimeStepCount(instance.geometry, unsigned(steps));
        for (int i = 0; i < steps; ++i) {
            const Float t = Float(i) / Float(steps - 1);
            // Infinite times give the two ends even if startTime == endTime.
            const Float time = i == 0 ? -Infinity : i == steps - 1 ? Infinity : Lerp(t, startTime, endTime);
            const Transform at = motion.At(time);
            NarrowReach(at);
            const RTCQuaternionDecomposition d = Decompose(glm::dmat4(at.Matrix()));
            rtcSetGeometryTransformQuaternion(instance.geometry, unsigned(i), &d);
        }
    }

    /// Lowers maxOrigin and maxDirection so that rays stay within Embree's bounds in the instance's space.
    void NarrowReach(const Transform &place) {
        const glm::mat4 &inverse = place.InverseMatrix();
        double factor = 0, shift = 0;
        for (int row = 0; row < 3; ++row) {
            double sum = 0;
            for (int c = 0; c < 3; ++c) sum += std::abs(double(inverse[c][row]));
            factor = std::max(factor, sum);
            shift = std::max(shift, std::abs(double(inverse[3][row])));
        }
        // Margin of one eighth for Embree's own inverse and interpolation in time.
        const double reach = double(kEmbreeReach) / 1.125;
        auto within = [&](double limit, Float old) {
            return limit > 0 ? Float(std::min(double(old), limit)) : Float(0);  // also for NaN
        };
        maxOrigin = within((reach - shift) / factor, maxOrigin);
        maxDirection = within(reach / factor, maxDirection);
    }
    /// Tests Embree's documented requirements on rays, which it asserts.
    bool IsRay(const Ray &ray) const {
        bool within = ray.tMax > 0;
        for (int c = 0; c < 3; ++c) within &= (std::abs(ray.o[c]) <= maxOrigin) & (std::abs(ray.d[c]) <= maxDirection);
        return within;
    }

    void CheckDevice() const {
        RTCError error = rtcGetDeviceError(device);
        if (error == RTC_ERROR_OUT_OF_MEMORY)
            throw UserError("There is not enough memory for the ray acceleration structure (this process can use {}).",
                            BytesText(UsableMemory()));
        PBRT_CHECK_MSG(error == RTC_ERROR_NONE, "Embree error {}", int(error));
    }
};

Accel::Accel(bool robust) : impl_(std::make_unique<Impl>(robust)) {}
Accel::~Accel() = default;

void Accel::LetShadowRaysThrough(ShapeId id, bool collect) {
    impl_->shadowless[id.value] = collect ? ShadowRays::Collected : ShadowRays::Passed;
}

void Accel::AddShape(ShapeId id, const Shape &shape, const FloatTexture *alpha) {
    impl_->Add(impl_->top, id, shape, alpha);
}

int Accel::AddObject(const std::vector<ShapeId> &ids, const std::vector<const Shape *> &shapes,
                     const std::vector<const FloatTexture *> &alphas, const Transform &renderFromObject) {
    PBRT_CHECK(ids.size() == shapes.size() && ids.size() == alphas.size());
    Impl::Group group;
    group.scene = impl_->NewScene();
    for (size_t i = 0; i < ids.size(); ++i) impl_->Add(group, ids[i], *shapes[i], alphas[i], renderFromObject);
    impl_->objects.push_back(std::move(group));
    return int(impl_->objects.size()) - 1;
}

int Accel::AddInstance(int object, const Transform &renderFromObject) {
    PBRT_CHECK(object >= 0 && size_t(object) < impl_->objects.size());
    impl_->instances.push_back({object, renderFromObject});
    return int(impl_->instances.size()) - 1;
}

int Accel::AddMovingInstance(int object, const AnimatedTransform &renderFromOuter,
                             const AnimatedTransform &outerFromObject) {
    for (const AnimatedTransform *t : {&renderFromOuter, &outerFromObject}) {
        if (!t->IsAnimated()) continue;
        if (!impl_->anyMoves) {
            impl_->anyMoves = true;
            impl_->startTime = t->StartTime();
            impl_->endTime = t->EndTime();
        }
        PBRT_CHECK(t->StartTime() == impl_->startTime && t->EndTime() == impl_->endTime);
    }
    const int instance = AddInstance(object, Transform());
    impl_->instances.back().motion = std::make_unique<Impl::Motion>(Impl::Motion{renderFromOuter, outerFromObject});
    return instance;
}

void Accel::Commit() {
    PBRT_CHECK(!impl_->committed);
    for (Impl::Group &g : impl_->objects) rtcCommitScene(g.scene);
    for (size_t i = 0; i < impl_->instances.size(); ++i) {
        Impl::Instance &instance = impl_->instances[i];
        const Impl::Group &object = impl_->objects[instance.object];
        if (object.geometries.empty()) continue;
        instance.geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(instance.geometry, object.scene);
        impl_->Place(instance);
        Impl::Attach(impl_->top, instance.geometry, nullptr, int32_t(i));
    }
    rtcCommitScene(impl_->top.scene);
    impl_->committed = true;
    impl_->CheckDevice();
    const Bounds3 bounds = Bounds();
    if (!bounds.IsEmpty() && !(MaxComponent(Max(Abs(bounds.low), Abs(bounds.high))) <= impl_->maxOrigin))
        throw ReachError(
            fmt::format("The scene reaches too far for its smallest object instance: rays that start beyond {:.2g} "
                        "cannot be traced in that instance's own coordinates. Scale the object itself instead of its "
                        "instance.",
                        impl_->maxOrigin));
}

Bounds3 Accel::Bounds() const {
    if (impl_->top.geometries.empty()) return {};
    RTCBounds b{};
    rtcGetSceneBounds(impl_->top.scene, &b);
    Bounds3 bounds;
    bounds.low = {b.lower_x, b.lower_y, b.lower_z};
    bounds.high = {b.upper_x, b.upper_y, b.upper_z};
    return bounds;
}

std::optional<AccelHit> Accel::Intersect(const Ray &ray, Float tMin) const {
    if (!impl_->IsRay(ray)) [[unlikely]]
        return {};
    QueryContext context(ray);
    RTCRayHit query{};
    query.ray = ToEmbree(ray, impl_->EmbreeTime(ray.time), tMin);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(impl_->top.scene, &context.base, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    AccelHit hit;
    const Impl::Group *group = &impl_->top;
    if (query.hit.instID[0] != RTC_INVALID_GEOMETRY_ID) {
        hit.instance = impl_->top.instances[query.hit.instID[0]];
        group = &impl_->objects[impl_->instances[hit.instance].object];
    }
    hit.shape = group->geometries[query.hit.geomID]->id;
    hit.primitive = query.hit.primID;
    hit.hit = {query.ray.tfar, query.hit.u, query.hit.v};
    return hit;
}

bool Accel::Occluded(const Ray &ray, PassedHits *passed) const {
    if (!impl_->IsRay(ray)) [[unlikely]]
        return true;
    QueryContext context(ray, passed);
    RTCRay query = ToEmbree(ray, impl_->EmbreeTime(ray.time));
    rtcOccluded1(impl_->top.scene, &context.base, &query);
    if (query.tfar < 0) return true;
    if (passed)
        for (AccelHit &hit : passed->Hits())
            if (hit.instance >= 0) hit.instance = impl_->top.instances[hit.instance];
    return false;
}

Transform Accel::InstanceTransform(int instance, Float time) const {
    const Impl::Instance &i = impl_->instances[instance];
    if (!i.motion) return i.transform;
    // Embree's transform rather than Motion::At: differences in the last digits could move a surface across the origin
    // of a ray leaving it.
    glm::mat4 m;
    rtcGetGeometryTransform(i.geometry, impl_->EmbreeTime(time), RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &m[0][0]);
    return Transform(m);
}

size_t Accel::Bytes() const { return size_t(std::max<int64_t>(0, impl_->bytes.load())); }

}  // namespace pbrt
