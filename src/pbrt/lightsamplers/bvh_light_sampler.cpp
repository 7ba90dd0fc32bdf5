// g++ 12 warns about its own AVX-512 header.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#include "pbrt/lightsamplers/bvh_light_sampler.h"

#include <array>
#include <bit>

#include <nlohmann/json.hpp>

#include "pbrt/math/lanes.h"

namespace pbrt {
namespace {

constexpr Float kSteps = 65535;

Float DecodeCosine(uint16_t q) { return Float(q) * (2 / kSteps) - 1; }

/// Largest code whose cosine is at most c.
uint16_t EncodeCosineDown(Float c) {
    auto q = int(std::floor((std::clamp(c, Float(-1), Float(1)) + 1) / 2 * kSteps));
    q = std::clamp(q, 0, 65535);
    while (q > 0 && DecodeCosine(uint16_t(q)) > c) --q;
    return uint16_t(q);
}

Float SignOf(Float v) { return std::copysign(Float(1), v); }

void EncodeAxis(const Vector3 &w, uint16_t q[2]) {
    Vector3 v = w / (std::abs(w.x) + std::abs(w.y) + std::abs(w.z));
    if (v.z < 0) v = {(1 - std::abs(v.y)) * SignOf(v.x), (1 - std::abs(v.x)) * SignOf(v.y), v.z};
    for (int i = 0; i < 2; ++i) q[i] = uint16_t(std::lround(std::clamp((v[i] + 1) / 2, Float(0), Float(1)) * kSteps));
}

Vector3 DecodeAxis(const uint16_t q[2]) {
    Vector3 v(DecodeCosine(q[0]), DecodeCosine(q[1]), 0);
    v.z = 1 - std::abs(v.x) - std::abs(v.y);
    if (v.z < 0) v = {(1 - std::abs(v.y)) * SignOf(v.x), (1 - std::abs(v.x)) * SignOf(v.y), v.z};
    return Normalize(v);
}

/// Cost of a cluster of emitters (Conty and Kulla 2018, Eq. 1, measure of 4.2; `stretch` penalizes thin boxes).
double SplitCost(const LightBounds &b, Float stretch) {
    if (!(b.phi > 0)) return 0;
    Float o = SafeACos(b.cosTheta_o), e = SafeACos(b.cosTheta_e);
    Float w = std::min(o + e, Pi), sinO = SafeSqrt(1 - Sqr(b.cosTheta_o));
    Float orientation =
        2 * Pi * (1 - b.cosTheta_o) + Pi / 2 * (2 * w * sinO - std::cos(o - 2 * w) - 2 * o * sinO + b.cosTheta_o);
    return b.phi * double(orientation) * double(stretch) * double(b.bounds.SurfaceArea());
}

constexpr int kBuckets = 12;

int BucketOf(Float position, Float low, Float high) {
    return std::clamp(int(kBuckets * ((position - low) / (high - low))), 0, kBuckets - 1);
}

struct Split {
    int axis = 0, bucket = 0;
    double cost = std::numeric_limits<double>::infinity();
};

/// Split of least cost into buckets of centroids; its cost is infinite if there is none. `box`: around the items.
template <class Item>
Split FindSplit(std::span<const Item> items, const Bounds3 &box, const Bounds3 &centroids) {
    const Vector3 extent = box.Diagonal();
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        Float low = centroids.low[axis], high = centroids.high[axis];
        if (!(high > low)) continue;
        std::array<LightBounds, kBuckets> buckets, above;
        for (const Item &item : items) {
            LightBounds &bucket = buckets[BucketOf(item.centroid[axis], low, high)];
            bucket = Union(bucket, item.bounds);
        }
        above[kBuckets - 1] = buckets[kBuckets - 1];
        for (size_t i = kBuckets - 1; i > 0; --i) above[i - 1] = Union(buckets[i - 1], above[i]);
        Float stretch = MaxComponent(extent) / std::max(extent[axis], std::numeric_limits<Float>::min());
        LightBounds below;
        for (size_t i = 0; i + 1 < kBuckets; ++i) {
            below = Union(below, buckets[i]);
            const double cost = SplitCost(below, stretch) + SplitCost(above[i + 1], stretch);
            if (cost > 0 && cost < best.cost) best = {axis, int(i), cost};
        }
    }
    return best;
}

/// Reorders the items by a split, or without one by halves, and returns the number of items in the first part.
template <class Item>
size_t Divide(std::span<Item> items, const Split &split, const Bounds3 &centroids) {
    size_t middle = 0;
    if (std::isfinite(split.cost)) {
        Float low = centroids.low[split.axis], high = centroids.high[split.axis];
        auto end = std::partition(items.begin(), items.end(), [&](const Item &item) {
            return BucketOf(item.centroid[split.axis], low, high) <= split.bucket;
        });
        middle = size_t(end - items.begin());
    }
    if (middle == 0 || middle == items.size()) {
        int axis = centroids.LongestAxis();
        middle = items.size() / 2;
        std::nth_element(items.begin(), items.begin() + middle, items.end(), [axis](const Item &a, const Item &b) {
            return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis] : a.light < b.light;
        });
    }
    return middle;
}

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

void LightBvhBlock::Set(uint32_t lane, const LightBvhNode &node) {
    centerX[lane] = node.center_.x;
    centerY[lane] = node.center_.y;
    centerZ[lane] = node.center_.z;
    radius[lane] = node.radius_;
    phi[lane] = (node.link_ & LightBvhNode::kTwoSided) != 0 ? -node.phi_ : node.phi_;
    axisU[lane] = node.axis_[0];
    axisV[lane] = node.axis_[1];
    cosO[lane] = node.cosO_;
    cosE[lane] = node.cosE_;
    link[lane] = node.LinkAndKind();
}

LightBvhNode LightBvhBlock::Node(uint32_t lane) const {
    LightBvhNode node;
    node.center_ = {centerX[lane], centerY[lane], centerZ[lane]};
    node.radius_ = radius[lane];
    node.phi_ = std::abs(phi[lane]);
    node.axis_[0] = axisU[lane];
    node.axis_[1] = axisV[lane];
    node.cosO_ = cosO[lane];
    node.cosE_ = cosE[lane];
    node.link_ = link[lane] | (phi[lane] < 0 ? LightBvhNode::kTwoSided : 0);
    return node;
}

// noinline: bit-identical results for all call sites.
[[gnu::noinline]] void LightBvhBlock::Importances(const Point3 &p, const Normal3 &n, Float out[kLanes]) const {
    using Ops = SimdOps<kLanes>;
    using F = Ops::F;
    auto load = [](const Float *values) { return Ops::Load(values); };
    auto cosine = [](const uint16_t *q) {
        const auto codes = LoadLanes<LanesOf<uint16_t, kLanes>>(q);
        const auto numbers = __builtin_convertvector(codes, LanesOf<int32_t, kLanes>);
        alignas(F) Float v[kLanes];
        StoreLanes(__builtin_convertvector(numbers, LanesOf<Float, kLanes>), v);
        return Ops::Load(v) * F(2 / kSteps) - F(1);
    };
    auto withSign = [](const F &size, const F &sign) { return Ops::Select(sign < F(0), -size, size); };

    const F u = cosine(axisU), v = cosine(axisV);
    const F z = F(1) - Ops::Abs(u) - Ops::Abs(v);
    const F x = Ops::Select(z < F(0), withSign(F(1) - Ops::Abs(v), u), u);
    const F y = Ops::Select(z < F(0), withSign(F(1) - Ops::Abs(u), v), v);
    const F cosTheta_o = cosine(cosO);
    const F signedPhi = load(phi), length2 = x * x + y * y + z * z, sinTheta_o = detail::SineOf<Ops>(cosTheta_o);
    const detail::Emitters<F, Ops::Mask> e{
        load(centerX), load(centerY), load(centerZ), load(radius),    x, y, z, length2, Ops::Abs(signedPhi),
        cosTheta_o,    sinTheta_o,    cosine(cosE),  signedPhi < F(0)};
    Ops::Store(detail::ImportanceOf<Ops>(e, p, n), out);
}

/// Packs child pairs into blocks. A block holds the children of a node, then those of its most powerful descendants.
/// Small subtrees are not divided.
class LightBvh::Packing {
  public:
    explicit Packing(std::span<const Pair> pairs) : pairs_(pairs), size_(pairs.size(), 1), place_(pairs.size()) {
        for (size_t i = pairs.size(); i-- > 0;)  // children follow their parents
            for (const LightBvhNode &child : pairs[i].child)
                if (!child.IsLeaf()) size_[i] += size_[child.Link()];
        std::vector<uint32_t> tops{0};
        while (!tops.empty()) {
            const uint32_t top = tops.back();
            tops.pop_back();
            if (size_[top] < kPairs) small_[size_[top]].push_back(top);
            else PlaceWithMostPowerful(top, &tops);
        }
        PlaceSmall();
    }

    uint32_t PlaceOf(uint32_t pair) const { return place_[pair]; }
    std::vector<LightBvhBlock> Blocks() const {
        std::vector<LightBvhBlock> blocks((next_ + kPairs - 1) / kPairs);
        for (size_t i = 0; i < pairs_.size(); ++i)
            for (uint32_t c = 0; c < 2; ++c) {
                LightBvhNode child = pairs_[i].child[c];
                if (!child.IsLeaf()) child.LinkTo(place_[child.Link()]);
                blocks[place_[i] / kPairs].Set(2 * (place_[i] % kPairs) + c, child);
            }
        return blocks;
    }

  private:
    static constexpr uint32_t kPairs = LightBvhBlock::kPairs;

    /// Fills one block and appends the nodes below it to `tops`.
    void PlaceWithMostPowerful(uint32_t top, std::vector<uint32_t> *tops) {
        std::vector<LightBvhNode> below;
        uint32_t pair = top;
        for (uint32_t i = 0;; ++i) {
            place_[pair] = next_++;
            for (const LightBvhNode &child : pairs_[pair].child)
                if (!child.IsLeaf()) below.push_back(child);
            if (i + 1 == kPairs) break;
            auto strongest = std::max_element(below.begin(), below.end(), [](const auto &a, const auto &b) {
                return a.Sphere().phi < b.Sphere().phi;
            });
            pair = strongest->Link();
            below.erase(strongest);
        }
        for (const LightBvhNode &node : below) tops->push_back(node.Link());
    }
    void PlaceSmall() {
        for (uint32_t free = kPairs;;) {
            uint32_t size = free;
            while (size > 0 && (size == kPairs || small_[size].empty())) --size;
            if (size == 0 && free == kPairs) return;
            if (size == 0) {
                next_ += free;
                free = kPairs;
                continue;
            }
            PlaceAll(small_[size].back());
            small_[size].pop_back();
            free -= size;
            if (free == 0) free = kPairs;
        }
    }
    void PlaceAll(uint32_t pair) {
        place_[pair] = next_++;
        for (const LightBvhNode &child : pairs_[pair].child)
            if (!child.IsLeaf()) PlaceAll(child.Link());
    }

    std::span<const Pair> pairs_;
    std::vector<uint32_t> size_;   ///< pairs per subtree
    std::vector<uint32_t> place_;  ///< index of a pair in all blocks
    std::array<std::vector<uint32_t>, kPairs> small_;
    uint32_t next_ = 0;
};

LightBvh::LightBvh(std::span<const LightCandidate> candidates) : trails_(candidates.size(), NotInTree) {
    std::vector<Item> items;
    for (size_t i = 0; i < candidates.size(); ++i) {
        const LightCandidate &c = candidates[i];
        if (c.infinite || !c.bounds || !(c.bounds->phi > 0)) continue;
        items.push_back({*c.bounds, c.bounds->Centroid(), uint32_t(i)});
    }
    if (items.empty()) return;
    std::vector<Pair> pairs;
    pairs.reserve(items.size() - 1);
    LightBounds all;
    root_ = Build(items, 0, 0, &all, &pairs);
    hasRoot_ = true;
    pairCount_ = pairs.size();
    if (pairs.empty()) return;
    const Packing packing(pairs);
    blocks_ = packing.Blocks();
    root_.LinkTo(packing.PlaceOf(root_.Link()));
}

LightBvhNode LightBvh::Build(std::span<Item> items, uint64_t trail, int depth, LightBounds *bounds,
                             std::vector<Pair> *pairs) {
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
    // Halving needs bit_width(size) more levels; without spare levels in the trail, the split must be balanced.
    const bool mustHalve = depth + std::bit_width(items.size()) >= kMaxDepth;
    const Split split = mustHalve ? Split{} : FindSplit(std::span<const Item>(items), box, centroids);
    const size_t middle = Divide(items, split, centroids);

    auto pair = uint32_t(pairs->size());
    pairs->emplace_back();
    LightBounds left, right;
    LightBvhNode first = Build(items.first(middle), trail, depth + 1, &left, pairs);
    LightBvhNode second = Build(items.subspan(middle), trail | (uint64_t(1) << depth), depth + 1, &right, pairs);
    (*pairs)[pair] = {{first, second}};
    *bounds = Union(left, right);
    return {*bounds, false, pair};
}

BVHLightSampler::BVHLightSampler(const LightGroups &groups)
    : GroupLightSampler(groups, true), tree_(groups.Candidates()), infinite_(groups, !tree_.IsEmpty()) {}

std::optional<GroupLightSampler::ChosenGroup> BVHLightSampler::ChooseGroup(const LightQuery &query, const void *,
                                                                           Float u) const {
    auto rest = double(u);
    if (!(infinite_.Pmf() > 0)) return {};
    uint32_t infinite;
    if (!infinite_.ChooseBounded(rest, &infinite)) return ChosenGroup{infinite, infinite_.Pmf(), InnerNumber(query, u)};
    if (!Reaches(query)) return {};
    const auto end = WalkDown(tree_, tree_.Root().LinkAndKind(), query, rest);
    if (!end) return {};
    const Float pmf = infinite_.Pmf() * end->pmf;
    if (!(pmf > 0)) return {};
    return ChosenGroup{LightBvh::Light(end->node), pmf, InnerNumber(query, u)};
}

Float BVHLightSampler::GroupProbability(const LightQuery &query, const void *, uint32_t group) const {
    if (infinite_.Holds(group)) return infinite_.Pmf();
    uint64_t trail = tree_.Trail(group);
    if (trail == LightBvh::NotInTree || !Reaches(query)) return 0;
    LightBvh::Node node = tree_.Root().LinkAndKind();
    const Float pmf = WalkProbability(tree_, &node, query, [&](LightBvh::Node, const LightBvh::Level &) {
        const auto i = uint32_t(trail & 1);
        trail >>= 1;
        return i;
    });
    return infinite_.Pmf() * pmf;
}

void BVHLightSampler::Report(nlohmann::ordered_json &json) const {
    json["nodes"] = tree_.IsEmpty() ? 0 : 2 * tree_.PairCount() + 1;
    json["depth"] = tree_.Depth();
    json["bytes"] = tree_.Bytes() + infinite_.Bytes();
    GroupLightSampler::Report(json);
}

}  // namespace pbrt
