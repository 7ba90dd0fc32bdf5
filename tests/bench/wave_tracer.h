#pragma once
#include <array>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include "pbrt/accel/embree_callbacks.h"
#include "pbrt/core/error.h"

namespace pbrt {

constexpr size_t kLanes = 8;  ///< rays of a packet

/// Rays of one kind that paths side by side would have at once; not empty.
struct Wave {
    std::span<const Ray> rays;
    bool isShadow, isCoherent;
};

/// Context of all queries here. RTCRay::id is the number of the ray in its wave, so that callbacks find the ray.
struct WaveContext {
    QueryContext query;
    const Ray *rays;

    WaveContext(const Wave &wave, bool isCoherent) : query(wave.rays.front()), rays(wave.rays.data()) {
        if (isCoherent) query.base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
    static void Select(RTCIntersectContext *context, uint32_t id) {
        auto *wave = reinterpret_cast<WaveContext *>(context);
        wave->query.ray = wave->rays + id;
    }
};
static_assert(std::is_standard_layout_v<WaveContext>);

// The callbacks of accel take one ray at a time; these call them for each lane of a packet.

inline void AlphaFilterLanes(const RTCFilterFunctionNArguments *args) {
    if (args->N == 1) {
        WaveContext::Select(args->context, RTCRayN_id(args->ray, 1, 0));
        return AlphaFilter(args);
    }
    for (uint32_t i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        RTCRay ray = rtcGetRayFromRayN(args->ray, args->N, i);
        RTCHit hit = rtcGetHitFromHitN(args->hit, args->N, i);
        WaveContext::Select(args->context, ray.id);
        RTCFilterFunctionNArguments lane = *args;
        lane.valid = args->valid + i;
        lane.ray = reinterpret_cast<RTCRayN *>(&ray);
        lane.hit = reinterpret_cast<RTCHitN *>(&hit);
        lane.N = 1;
        AlphaFilter(&lane);
    }
}

inline void UserIntersectLanes(const RTCIntersectFunctionNArguments *args) {
    if (args->N == 1) {
        WaveContext::Select(args->context, RTCRayN_id(RTCRayHitN_RayN(args->rayhit, 1), 1, 0));
        return UserIntersect(args);
    }
    for (uint32_t i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        RTCRayHit query = rtcGetRayHitFromRayHitN(args->rayhit, args->N, i);
        WaveContext::Select(args->context, query.ray.id);
        RTCIntersectFunctionNArguments lane = *args;
        lane.valid = args->valid + i;
        lane.rayhit = reinterpret_cast<RTCRayHitN *>(&query);
        lane.N = 1;
        UserIntersect(&lane);
        float &tFar = RTCRayN_tfar(RTCRayHitN_RayN(args->rayhit, args->N), args->N, i);
        if (!(query.ray.tfar < tFar)) continue;
        tFar = query.ray.tfar;
        rtcCopyHitToHitN(RTCRayHitN_HitN(args->rayhit, args->N), &query.hit, args->N, i);
    }
}

inline const RTCOccludedFunctionN kUserOccluded = CallbacksFor(ShadowRays::Blocked, false).userGeometry;

inline void UserOccludedLanes(const RTCOccludedFunctionNArguments *args) {
    if (args->N == 1) {
        WaveContext::Select(args->context, RTCRayN_id(args->ray, 1, 0));
        return kUserOccluded(args);
    }
    for (uint32_t i = 0; i < args->N; ++i) {
        if (args->valid[i] == 0) continue;
        RTCRay ray = rtcGetRayFromRayN(args->ray, args->N, i);
        WaveContext::Select(args->context, ray.id);
        RTCOccludedFunctionNArguments lane = *args;
        lane.valid = args->valid + i;
        lane.ray = reinterpret_cast<RTCRayN *>(&ray);
        lane.N = 1;
        kUserOccluded(&lane);
        RTCRayN_tfar(args->ray, args->N, i) = ray.tfar;
    }
}

inline bool IsMoving(RTCGeometry instance) {
    std::array<float, 16> start{}, end{};
    rtcGetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, start.data());
    rtcGetGeometryTransform(instance, 1, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, end.data());
    return start != end;
}

/// Replaces the callbacks of the scene by those above; from then on only queries with a WaveContext are valid. "path"
/// has shadow rays that every surface blocks (ShadowRays::Blocked). Returns the top level.
inline RTCScene ReplaceCallbacks(const Accel &accel) {
    const std::vector<Accel::EmbreeScene> scenes = accel.EmbreeScenes();
    for (const auto &[scene, geometryCount] : scenes)
        for (uint32_t i = 0; i < geometryCount; ++i) {
            RTCGeometry g = rtcGetGeometry(scene, i);
            const auto *geometry = static_cast<const Geometry *>(rtcGetGeometryUserData(g));
            if (!geometry) {
                if (IsMoving(g)) throw UserError("The scene has moving shapes, which this benchmark cannot trace.");
            } else if (!geometry->hitsOnce) {
                rtcSetGeometryIntersectFunction(g, UserIntersectLanes);
                rtcSetGeometryOccludedFunction(g, UserOccludedLanes);
            } else if (geometry->alpha) {
                rtcSetGeometryIntersectFilterFunction(g, AlphaFilterLanes);
                rtcSetGeometryOccludedFilterFunction(g, AlphaFilterLanes);
            }
        }
    return scenes.front().scene;
}

struct Found {
    Float t = Infinity;  ///< Infinity: no hit; 0: blocked, for shadow rays
    Float u = 0, v = 0;
    uint32_t primitive = 0, geometry = 0, instance = 0;
};

inline Float BlockedAt(Float tFar) { return tFar < 0 ? 0 : Infinity; }

// Embree accepts hits at tnear (ToEmbree in accel.cpp).
constexpr Float kNear = std::numeric_limits<Float>::min();

inline RTCRay ToEmbree(const Ray &ray, uint32_t id) {
    return {ray.o.x, ray.o.y, ray.o.z, kNear, ray.d.x, ray.d.y, ray.d.z, 0, ray.tMax, 0xffffffffu, id, 0};
}

inline RTCRayHit QueryFor(const Ray &ray, uint32_t id) {
    RTCRayHit query{};
    query.ray = ToEmbree(ray, id);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
}

inline Found ResultOf(const RTCRayHit &query) {
    const RTCHit &hit = query.hit;
    if (hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {query.ray.tfar, hit.u, hit.v, hit.primID, hit.geomID, hit.instID[0]};
}

inline void FillLane(RTCRay8 &packet, size_t k, const Ray &ray, uint32_t id) {
    packet.org_x[k] = ray.o.x;
    packet.org_y[k] = ray.o.y;
    packet.org_z[k] = ray.o.z;
    packet.tnear[k] = kNear;
    packet.dir_x[k] = ray.d.x;
    packet.dir_y[k] = ray.d.y;
    packet.dir_z[k] = ray.d.z;
    packet.time[k] = 0;
    packet.tfar[k] = ray.tMax;
    packet.mask[k] = 0xffffffffu;
    packet.id[k] = id;
    packet.flags[k] = 0;
}

inline Found ResultOf(const RTCRayHit8 &packet, size_t k) {
    const RTCHit8 &hit = packet.hit;
    if (hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) return {};
    return {packet.ray.tfar[k], hit.u[k], hit.v[k], hit.primID[k], hit.geomID[k], hit.instID[0][k]};
}

/// Ways to trace a wave: one by one, as Accel does; in packets of kLanes; in such packets after sorting by the octant
/// of the direction; by rtcIntersect1M and rtcOccluded1M.
enum Way { kSingle, kPackets, kSorted, kStream, kWayCount };
using PerWay = std::array<double, kWayCount>;

/// Traces waves; keeps its buffers between them.
class WaveTracer {
  public:
    explicit WaveTracer(RTCScene scene) : scene_(scene) {}

    /// `found`: one result per ray of the wave, in its order.
    void Trace(Way way, const Wave &wave, Found *found) {
        switch (way) {
            case kSingle: return TraceSingle(wave, found);
            case kPackets: return TracePackets(wave, found, [](size_t i) { return uint32_t(i); });
            case kSorted:
                SortByOctant(wave.rays);
                return TracePackets(wave, found, [this](size_t i) { return order_[i]; });
            case kStream: return TraceStream(wave, found);
            case kWayCount: break;
        }
    }

  private:
    void TraceSingle(const Wave &wave, Found *found) {
        WaveContext context(wave, false);
        for (uint32_t i = 0; i < wave.rays.size(); ++i) {
            if (wave.isShadow) {
                RTCRay query = ToEmbree(wave.rays[i], i);
                rtcOccluded1(scene_, &context.query.base, &query);
                found[i].t = BlockedAt(query.tfar);
            } else {
                RTCRayHit query = QueryFor(wave.rays[i], i);
                rtcIntersect1(scene_, &context.query.base, &query);
                found[i] = ResultOf(query);
            }
        }
    }
    /// order(i): number of the ray at position i.
    void TracePackets(const Wave &wave, Found *found, auto &&order) {
        WaveContext context(wave, wave.isCoherent);
        for (size_t first = 0; first < wave.rays.size(); first += kLanes) {
            const size_t count = std::min(kLanes, wave.rays.size() - first);
            alignas(32) int valid[kLanes];
            RTCRayHit8 packet;
            for (size_t k = 0; k < kLanes; ++k) {
                valid[k] = k < count ? -1 : 0;
                const uint32_t id = order(first + std::min(k, count - 1));
                FillLane(packet.ray, k, wave.rays[id], id);
                packet.hit.geomID[k] = packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
            }
            if (wave.isShadow) rtcOccluded8(valid, scene_, &context.query.base, &packet.ray);
            else rtcIntersect8(valid, scene_, &context.query.base, &packet);
            for (size_t k = 0; k < count; ++k) {
                Found &to = found[order(first + k)];
                if (wave.isShadow) to.t = BlockedAt(packet.ray.tfar[k]);
                else to = ResultOf(packet, k);
            }
        }
    }
    void TraceStream(const Wave &wave, Found *found) {
        WaveContext context(wave, wave.isCoherent);
        const auto count = uint32_t(wave.rays.size());
        if (wave.isShadow) {
            shadowStream_.resize(count);
            for (uint32_t i = 0; i < count; ++i) shadowStream_[i] = ToEmbree(wave.rays[i], i);
            rtcOccluded1M(scene_, &context.query.base, shadowStream_.data(), count, sizeof(RTCRay));
            for (uint32_t i = 0; i < count; ++i) found[i].t = BlockedAt(shadowStream_[i].tfar);
        } else {
            stream_.resize(count);
            for (uint32_t i = 0; i < count; ++i) stream_[i] = QueryFor(wave.rays[i], i);
            rtcIntersect1M(scene_, &context.query.base, stream_.data(), count, sizeof(RTCRayHit));
            for (uint32_t i = 0; i < count; ++i) found[i] = ResultOf(stream_[i]);
        }
    }
    void SortByOctant(std::span<const Ray> rays) {
        const auto octant = [](const Vector3 &d) { return (d.x < 0 ? 1 : 0) + (d.y < 0 ? 2 : 0) + (d.z < 0 ? 4 : 0); };
        std::array<uint32_t, 9> start{};
        for (const Ray &ray : rays) ++start[octant(ray.d) + 1];
        for (size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
        order_.resize(rays.size());
        for (uint32_t i = 0; i < rays.size(); ++i) order_[start[octant(rays[i].d)]++] = i;
    }

    RTCScene scene_;
    std::vector<uint32_t> order_;
    std::vector<RTCRayHit> stream_;
    std::vector<RTCRay> shadowStream_;
};

}  // namespace pbrt
