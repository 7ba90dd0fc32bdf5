#include "pbrt/lightsamplers/light_bvh.h"

#include <array>
#include <bit>
#include <optional>

#include "pbrt/core/error.h"
#include "pbrt/lightsamplers/light_packet.h"

namespace pbrt {

namespace {

constexpr Float kSteps = 65535;

Float DecodeCosine(uint16_t q) { return static_cast<Float>(q) * (2 / kSteps) - 1; }

/// Largest code whose cosine is not above c.
uint16_t EncodeCosineDown(Float c) {
    auto q = static_cast<int>(std::floor((std::clamp(c, Float(-1), Float(1)) + 1) / 2 * kSteps));
    q = std::clamp(q, 0, 65535);
    while (q > 0 && DecodeCosine(static_cast<uint16_t>(q)) > c) --q;
    return static_cast<uint16_t>(q);
}

Float SignOf(Float v) { return std::copysign(Float(1), v); }

void EncodeAxis(const Vector3 &w, uint16_t q[2]) {
    Vector3 v = w / (std::abs(w.x) + std::abs(w.y) + std::abs(w.z));
    if (v.z < 0) v = {(1 - std::abs(v.y)) * SignOf(v.x), (1 - std::abs(v.x)) * SignOf(v.y), v.z};
    for (int i = 0; i < 2; ++i)
        q[i] = static_cast<uint16_t>(std::lround(std::clamp((v[i] + 1) / 2, Float(0), Float(1)) * kSteps));
}

Vector3 DecodeAxis(const uint16_t q[2]) {
    Vector3 v(DecodeCosine(q[0]), DecodeCosine(q[1]), 0);
    v.z = 1 - std::abs(v.x) - std::abs(v.y);
    if (v.z < 0) v = {(1 - std::abs(v.y)) * SignOf(v.x), (1 - std::abs(v.x)) * SignOf(v.y), v.z};
    return Normalize(v);
}

/// How much it costs to keep these emitters together (Conty and Kulla 2018, Eq. 1 with the measure of section 4.2;
/// `stretch` punishes thin boxes).
Float SplitCost(const LightBounds &b, Float stretch) {
    if (!(b.phi > 0)) return 0;
    Float o = SafeACos(b.cosTheta_o), e = SafeACos(b.cosTheta_e);
    Float w = std::min(o + e, Pi), sinO = SafeSqrt(1 - Sqr(b.cosTheta_o));
    Float orientation =
        2 * Pi * (1 - b.cosTheta_o) + Pi / 2 * (2 * w * sinO - std::cos(o - 2 * w) - 2 * o * sinO + b.cosTheta_o);
    return b.phi * orientation * stretch * b.bounds.SurfaceArea();
}

constexpr int kBuckets = 12;

int BucketOf(Float position, Float low, Float high) {
    return std::clamp(static_cast<int>(kBuckets * ((position - low) / (high - low))), 0, kBuckets - 1);
}

struct Split {
    int axis = 0, bucket = 0;
    Float cost = Infinity;
};

}  // namespace

LightBvhNode::LightBvhNode(const LightBounds &bounds, bool isLeaf, uint32_t link) {
    PBRT_CHECK(link <= kLinkMask);
    LightSphere s = bounds.Sphere();
    center_ = s.center;
    radius_ = s.radius * Float(1.000001);
    phi_ = s.phi;
    EncodeAxis(s.w, axis_);
    Float tilt = AngleBetween(Normalize(s.w), DecodeAxis(axis_)) + Float(1e-6);
    Float o = SafeACos(s.cosTheta_o) + tilt;
    cosO_ = EncodeCosineDown(o >= Pi ? Float(-1) : std::cos(o));
    cosE_ = EncodeCosineDown(s.cosTheta_e);
    link_ = link | (isLeaf ? kLeaf : 0) | (s.twoSided ? kTwoSided : 0);
}

LightSphere LightBvhNode::Sphere() const {
    return {
        center_, radius_, DecodeAxis(axis_), phi_, DecodeCosine(cosO_), DecodeCosine(cosE_), (link_ & kTwoSided) != 0};
}

void LightBvhPair::Importances(const Point3 &p, const Normal3 &n, Float out[2]) const {
    // Four lanes because that is the narrowest register; the upper two repeat the lower ones.
    using Ops = SimdOps<4>;
    using F = Ops::F;
    auto gather = [this](auto field) { return F([&](auto i) { return static_cast<Float>(field(child[i & 1])); }); };
    auto cosine = [](const F &q) { return q * F(2 / kSteps) - F(1); };
    auto withSign = [](const F &size, const F &sign) { return Ops::Select(sign < F(0), -size, size); };

    F u = cosine(gather([](const LightBvhNode &c) { return c.axis_[0]; }));
    F v = cosine(gather([](const LightBvhNode &c) { return c.axis_[1]; }));
    F z = F(1) - Ops::Abs(u) - Ops::Abs(v);
    F x = Ops::Select(z < F(0), withSign(F(1) - Ops::Abs(v), u), u);
    F y = Ops::Select(z < F(0), withSign(F(1) - Ops::Abs(u), v), v);
    F normalise = F(1) / Ops::Sqrt(x * x + y * y + z * z);
    F cosO = cosine(gather([](const LightBvhNode &c) { return c.cosO_; }));

    detail::Emitters<F, Ops::Mask> e{
        gather([](const LightBvhNode &c) { return c.center_.x; }),
        gather([](const LightBvhNode &c) { return c.center_.y; }),
        gather([](const LightBvhNode &c) { return c.center_.z; }),
        gather([](const LightBvhNode &c) { return c.radius_; }),
        x * normalise,
        y * normalise,
        z * normalise,
        gather([](const LightBvhNode &c) { return c.phi_; }),
        detail::FromCosine<Ops>(cosO),
        cosine(gather([](const LightBvhNode &c) { return c.cosE_; })),
        gather([](const LightBvhNode &c) { return (c.link_ & LightBvhNode::kTwoSided) != 0; }) != F(0)};
    F importance = detail::ImportanceOf<Ops>(e, p, n);
    out[0] = importance[0];
    out[1] = importance[1];
}

LightBvh::LightBvh(std::span<const LightCandidate> candidates) : trails_(candidates.size(), NotInTree) {
    std::vector<Item> items;
    for (size_t i = 0; i < candidates.size(); ++i) {
        const LightCandidate &c = candidates[i];
        if (c.infinite || !c.bounds || !(c.bounds->phi > 0)) continue;
        items.push_back({*c.bounds, c.bounds->Centroid(), static_cast<uint32_t>(i)});
    }
    if (items.empty()) return;
    pairs_.reserve(items.size() - 1);
    LightBounds all;
    root_ = Build(items, 0, 0, &all);
    hasRoot_ = true;
}

LightBvhNode LightBvh::Build(std::span<Item> items, uint64_t trail, int depth, LightBounds *bounds) {
    depth_ = std::max(depth_, depth);
    if (items.size() == 1) {
        trails_[items[0].light] = trail;
        *bounds = items[0].bounds;
        return {items[0].bounds, true, items[0].light};
    }
    PBRT_CHECK(depth < kMaxDepth);

    Bounds3 box, centroids;
    for (const Item &item : items) {
        box = Union(box, item.bounds.bounds);
        centroids = Union(centroids, item.centroid);
    }
    Vector3 extent = box.Diagonal();
    Split best;
    // Halving needs bit_width(size) more levels; if the trail has room for no more, the split must be balanced.
    bool mustHalve = depth + std::bit_width(items.size()) >= kMaxDepth;
    for (int axis = 0; axis < 3 && !mustHalve; ++axis) {
        Float low = centroids.low[axis], high = centroids.high[axis];
        if (!(high > low)) continue;
        std::array<LightBounds, kBuckets> buckets, above;
        for (const Item &item : items) {
            LightBounds &bucket = buckets[static_cast<size_t>(BucketOf(item.centroid[axis], low, high))];
            bucket = Union(bucket, item.bounds);
        }
        above[kBuckets - 1] = buckets[kBuckets - 1];
        for (size_t i = kBuckets - 1; i > 0; --i) above[i - 1] = Union(buckets[i - 1], above[i]);
        Float stretch = MaxComponent(extent) / std::max(extent[axis], std::numeric_limits<Float>::min());
        LightBounds below;
        for (size_t i = 0; i + 1 < kBuckets; ++i) {
            below = Union(below, buckets[i]);
            Float cost = SplitCost(below, stretch) + SplitCost(above[i + 1], stretch);
            if (cost > 0 && cost < best.cost) best = {axis, static_cast<int>(i), cost};
        }
    }

    size_t middle = 0;
    if (best.cost < Infinity) {
        Float low = centroids.low[best.axis], high = centroids.high[best.axis];
        auto end = std::partition(items.begin(), items.end(), [&](const Item &item) {
            return BucketOf(item.centroid[best.axis], low, high) <= best.bucket;
        });
        middle = static_cast<size_t>(end - items.begin());
    }
    if (middle == 0 || middle == items.size()) {
        int axis = centroids.LongestAxis();
        middle = items.size() / 2;
        std::nth_element(items.begin(), items.begin() + static_cast<ptrdiff_t>(middle), items.end(),
                         [axis](const Item &a, const Item &b) {
                             return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis]
                                                                         : a.light < b.light;
                         });
    }

    auto pair = static_cast<uint32_t>(pairs_.size());
    pairs_.emplace_back();
    LightBounds left, right;
    LightBvhNode first = Build(items.first(middle), trail, depth + 1, &left);
    LightBvhNode second = Build(items.subspan(middle), trail | (uint64_t(1) << depth), depth + 1, &right);
    pairs_[pair] = {{first, second}};
    *bounds = Union(left, right);
    return {*bounds, false, pair};
}

}  // namespace pbrt
