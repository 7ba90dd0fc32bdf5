#pragma once
#include <array>
#include <span>

#include "ext/lightgroups/emitter.h"

namespace ext {

/// Position and direction of an emitter as one vector, for clustering. Positions are relative to the bounds' diagonal:
/// its ends are 1 apart, opposite directions of flat emitters 0.7.
using EmitterFeature = std::array<Float, 6>;
inline EmitterFeature FeatureOf(const Emitter &e, const Point3 &center, Float invSize) {
    Vector3 place = (e.bounds->Centroid() - center) * invSize;
    Float direction = e.isArea && !e.bounds->twoSided ? Float(0.35) * (1 + e.bounds->cosTheta_o) / 2 : 0;
    Vector3 w = e.bounds->w * direction;
    return {place.x, place.y, place.z, w.x, w.y, w.z};
}

struct EmitterItem {
    uint32_t emitter = 0;
    Float weight = 0;
    EmitterFeature feature{};
};

/// Minimum emitters of a node whose children are built in parallel; LightTree splits such nodes at the median.
inline constexpr size_t kManyEmitters = 4096;

/// Sets the features of all items, relative to the bounds of their positions.
inline void FindFeatures(std::span<EmitterItem> items, std::span<const Emitter> emitters) {
    Bounds3 cloud;
    for (const EmitterItem &item : items) cloud = Union(cloud, emitters[item.emitter].bounds->Centroid());
    const Point3 center = items.empty() ? Point3(0) : cloud.Center();
    const Float size = items.empty() ? Float(1) : Length(cloud.Diagonal());
    const Float invSize = size > 0 ? 1 / size : 1;
    for (EmitterItem &item : items) item.feature = FeatureOf(emitters[item.emitter], center, invSize);
}

/// Feature axis of maximum spread over a list of items.
struct WidestAxis {
    double spread = 0;  ///< weighted sum of squared distances from the mean
    size_t axis = 0;

    explicit WidestAxis(std::span<const EmitterItem> items) {
        double mean[6] = {}, square[6] = {}, weight = 0;
        for (const EmitterItem &item : items) {
            auto w = double(item.weight);
            weight += w;
            for (size_t a = 0; a < 6; ++a) {
                mean[a] += w * double(item.feature[a]);
                square[a] += w * double(item.feature[a] * item.feature[a]);
            }
        }
        for (size_t a = 0; a < 6; ++a) {
            double v = weight > 0 ? square[a] - mean[a] * mean[a] / weight : 0;
            if (v > spread) {
                spread = v;
                axis = a;
            }
        }
    }
};

/// Orders by one feature coordinate, ties by index, so that the result is independent of the input order.
struct LessAlong {
    size_t axis = 0;
    bool operator()(const EmitterItem &a, const EmitterItem &b) const {
        return a.feature[axis] != b.feature[axis] ? a.feature[axis] < b.feature[axis] : a.emitter < b.emitter;
    }
};

}  // namespace ext
