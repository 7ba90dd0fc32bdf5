#include "ext/guiding/guide_cells.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "pbrt/math/frame.h"

namespace ext {
namespace {

/// Sine of the minimum cone half angle, 1.8 degrees: in narrower cones, rounding would decide whether a direction is
/// inside.
constexpr Float kMinSine = 0.0316f;
constexpr Float kMinSine2 = kMinSine * kMinSine;
/// Independent partial sums, for vectorization.
constexpr size_t kLanes = 8;
constexpr size_t kMinSamples = 8;
/// Approximate number of small clusters before merging.
constexpr size_t kSmallClusters = 256;
/// Positions over which cluster solid angles are averaged.
constexpr size_t kPlaces = 128;

using Lanes = std::array<Float, kLanes>;

Float SumOf(const Lanes &s) { return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7])); }

/// 1 - cos of a cone's half angle, from its squared sine.
Float OneMinusCosine(Float sine2) { return sine2 / (1 + std::sqrt(std::max(Float(0), 1 - sine2))); }

struct Cluster {
    size_t count = 0;
    double moment = 0;  ///< of the mean radiance: integral of its square over directions, summed over positions
    Bounds3 bounds;
    double cost = 0;              ///< cached Cost()
    std::vector<uint32_t> parts;  ///< small clusters merged into it

    Point3 Middle() const { return bounds.low + (bounds.high - bounds.low) * Float(0.5); }
    Float Radius2() const { return LengthSquared(bounds.high - Middle()); }
    /// Contribution to the root of the minimal second moment: the root of its moment times the solid angle it covers,
    /// which is proportional to its squared size.
    double Cost() const { return std::sqrt(moment) * double(Length(bounds.high - bounds.low)); }
};

struct Places {
    std::vector<Point3> some;
    double each = 1;  ///< events represented by each position

    double SolidAngle(const Point3 &middle, Float r2) const {
        double sum = 0;
        for (const Point3 &p : some) {
            const Float l2 = LengthSquared(middle - p);
            sum += l2 > r2 ? double(OneMinusCosine(std::max(r2 / l2, kMinSine2))) : 2;
        }
        return 2 * std::numbers::pi * each * sum;
    }
};

/// Without cost and parts.
Cluster Merged(const Cluster &a, const Cluster &b) {
    return {a.count + b.count, a.moment + b.moment, Union(a.bounds, b.bounds), 0, {}};
}

/// Splits the samples along their largest extent until they are few, or hold a small share of count and flux. The split
/// is at the mean of both, which lies beside a small bright spot and so separates it from its surroundings.
void AddSmallClusters(std::span<RadianceSample> samples, size_t largest, double fluxOfAll, size_t countOfAll,
                      const Places &places, std::vector<Cluster> *clusters) {
    Cluster cluster;
    cluster.count = samples.size();
    double flux = 0;
    for (const RadianceSample &f : samples) {
        cluster.bounds = Union(cluster.bounds, f.target);
        flux += f.radiance * f.perPdf;
    }
    const Vector3 size = cluster.bounds.high - cluster.bounds.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const auto weightOf = [&](const RadianceSample &f) {
        return f.radiance * f.perPdf / fluxOfAll + 1 / double(countOfAll);
    };
    const double weight = flux / fluxOfAll + double(cluster.count) / double(countOfAll);
    if (samples.size() <= largest || weight < 2 / double(kSmallClusters)) {
        const double meanRadiance = flux / places.SolidAngle(cluster.Middle(), cluster.Radius2());
        cluster.moment = flux * meanRadiance;
        if (!(cluster.moment > 0)) return;
        cluster.parts = {uint32_t(clusters->size())};
        for (RadianceSample &f : samples) {
            f.meanRadiance = meanRadiance;
            f.cluster = cluster.parts[0];
        }
        clusters->push_back(std::move(cluster));
        return;
    }
    double sum = 0;
    for (const RadianceSample &f : samples) sum += weightOf(f) * double(f.target[axis]);
    const auto mean = Float(sum / weight);
    const auto isBelow = [&](const RadianceSample &f) { return f.target[axis] < mean; };
    size_t middle = std::partition(samples.begin(), samples.end(), isBelow) - samples.begin();
    if (std::min(middle, samples.size() - middle) < kMinSamples) {
        middle = std::clamp(middle, kMinSamples, samples.size() - kMinSamples);
        std::ranges::nth_element(samples, samples.begin() + middle, {},
                                 [&](const RadianceSample &f) { return f.target[axis]; });
    }
    AddSmallClusters(samples.first(middle), largest, fluxOfAll, countOfAll, places, clusters);
    AddSmallClusters(samples.subspan(middle), largest, fluxOfAll, countOfAll, places, clusters);
}

/// Repeatedly merges the pair of clusters with the lowest cost increase.
void MergeClusters(std::vector<Cluster> *clusters) {
    struct Partner {
        size_t of = 0;
        double cost = std::numeric_limits<double>::infinity();
    };
    std::vector<Partner> best(clusters->size());
    const auto consider = [&](size_t i, size_t j) {
        const Cluster &a = (*clusters)[i], &b = (*clusters)[j];
        const double cost = i == j ? std::numeric_limits<double>::infinity() : Merged(a, b).Cost() - a.cost - b.cost;
        if (cost < best[i].cost) best[i] = {j, cost};
    };
    const auto find = [&](size_t i) {
        best[i] = {};
        for (size_t j = 0; j < clusters->size(); ++j) consider(i, j);
    };
    for (Cluster &cluster : *clusters) cluster.cost = cluster.Cost();
    for (size_t i = 0; i < clusters->size(); ++i) find(i);
    while (clusters->size() > kMaxSourceClusters) {
        size_t gone = 0;
        for (size_t k = 1; k < clusters->size(); ++k)
            if (best[k].cost < best[gone].cost) gone = k;
        const size_t kept = best[gone].of, last = clusters->size() - 1;
        Cluster merged = Merged((*clusters)[gone], (*clusters)[kept]);
        merged.cost = merged.Cost();
        merged.parts = std::move((*clusters)[kept].parts);
        merged.parts.insert(merged.parts.end(), (*clusters)[gone].parts.begin(), (*clusters)[gone].parts.end());
        (*clusters)[kept] = std::move(merged);
        if (gone != last) (*clusters)[gone] = std::move((*clusters)[last]);
        best[gone] = best[last];
        clusters->pop_back();
        best.pop_back();
        const size_t changed[] = {kept == last ? gone : kept, gone};
        for (size_t k = 0; k < clusters->size(); ++k) {
            const size_t of = best[k].of;
            if (k == changed[0] || of == kept || of == gone || of == last) {
                find(k);
                continue;
            }
            for (const size_t j : changed)
                if (j < clusters->size()) consider(k, j);
        }
    }
}

}  // namespace

std::vector<SourceCluster> MakeSourceClusters(std::span<RadianceSample> samples, std::span<const Point3> from,
                                              size_t bounces) {
    Places places;
    const size_t stride = (from.size() + kPlaces - 1) / kPlaces;
    for (size_t i = 0; i < from.size(); i += stride) places.some.push_back(from[i]);
    places.each = double(bounces) / double(places.some.size());
    const auto nothing =
        std::partition(samples.begin(), samples.end(), [](const RadianceSample &f) { return f.radiance > 0; });
    const auto positive = samples.first(nothing - samples.begin());
    if (positive.size() < kMinSamples) return {};
    std::vector<Cluster> clusters;
    double flux = 0;
    for (const RadianceSample &f : positive) flux += f.radiance * f.perPdf;
    AddSmallClusters(positive, 2 * kMinSamples, flux, positive.size(), places, &clusters);
    std::vector<uint32_t> mergedInto(clusters.size());
    MergeClusters(&clusters);
    std::vector<SourceCluster> made;
    for (const Cluster &cluster : clusters) {
        for (const uint32_t part : cluster.parts) mergedInto[part] = uint32_t(made.size());
        made.push_back({cluster.Middle(), 0, 0});
    }
    for (RadianceSample &f : positive) {
        if (f.cluster == RadianceSample::kNone) continue;
        f.cluster = mergedInto[f.cluster];
        SourceCluster &target = made[f.cluster];
        target.r2 = std::max(target.r2, LengthSquared(f.target - target.p));
    }
    for (size_t k = 0; k < made.size(); ++k)
        made[k].radiance = Float(std::sqrt(clusters[k].moment / places.SolidAngle(made[k].p, made[k].r2)));
    return made;
}

Float SolidAngleOf(const SourceCluster &target, const Point3 &p, const Vector3 &n, bool bothSides) {
    if (target.Contains(p)) return 0;
    const Vector3 d = target.p - p;
    const Float l2 = LengthSquared(d);
    const Float sine2 = std::max(target.r2 / l2, kMinSine2);
    const Float facing = bothSides ? 1 : std::min(Dot(d, n) / std::sqrt(l2) + std::sqrt(sine2), Float(1));
    return facing > 0 ? 2 * Pi * OneMinusCosine(sine2) * facing : 0;
}

SourceClusters::SourceClusters(std::span<const SourceCluster> made) : count(made.size()) {
    for (size_t k = 0; k < count; ++k) {
        x[k] = made[k].p.x;
        y[k] = made[k].p.y;
        z[k] = made[k].p.z;
        r[k] = std::sqrt(made[k].r2);
    }
}

void GuideDirections::Prepare(const SourceClusters &__restrict made, const PerSourceCluster &__restrict radiances,
                              const Point3 &at, const Vector3 &normal, bool bothSides) {
    static_assert(kMaxSourceClusters % kLanes == 0);
    // Copies exclude aliasing with the output, which would prevent vectorization.
    const Point3 p = at;
    const Vector3 n = normal;
    const Float always = bothSides ? 1 : 0;
    const size_t end = (made.count + kLanes - 1) / kLanes * kLanes;
    Lanes sums{};
    for (size_t first = 0; first < end; first += kLanes)
        for (size_t i = 0; i < kLanes; ++i) {
            const size_t k = first + i;
            const Float dx = made.x[k] - p.x, dy = made.y[k] - p.y, dz = made.z[k] - p.z;
            const Float l2 = std::max(dx * dx + dy * dy + dz * dz, std::numeric_limits<Float>::min());
            const Float perLength = 1 / std::sqrt(l2);
            const Float sine = std::max(made.r[k] * perLength, kMinSine);
            const Float facing =
                std::max(always, std::min((dx * n.x + dy * n.y + dz * n.z) * perLength + sine, Float(1)));
            const Float cosine = std::sqrt(std::max(1 - sine * sine, Float(0)));
            x_[k] = dx * perLength;
            y_[k] = dy * perLength;
            z_[k] = dz * perLength;
            cosine_[k] = cosine;
            density_[k] = sine < 1 ? radiances[k] * std::max(facing, Float(0)) : Float(0);
            probability_[k] = density_[k] * (2 * Pi) * (1 - cosine);
            sums[i] += probability_[k];
        }
    end_ = end;
    const Float total = SumOf(sums);
    isUsable_ = total > 0 && std::isfinite(total);
    const Float perTotal = isUsable_ ? 1 / total : 0;
    for (size_t first = 0; first < end; first += kLanes)
        for (size_t i = 0; i < kLanes; ++i) {
            density_[first + i] *= perTotal;
            probability_[first + i] *= perTotal;
        }
}

Vector3 GuideDirections::Sample(const Point2 &u) const {
    Float left = u.x;
    size_t k = 0, last = 0;
    for (; k < end_; ++k) {
        if (!(probability_[k] > 0)) continue;
        last = k;
        if (left < probability_[k]) break;
        left -= probability_[k];
    }
    k = last;
    const Float along = std::clamp(left / probability_[k], Float(0), OneMinusEpsilon);
    const Float z = 1 - along * (1 - cosine_[k]), r = std::sqrt(std::max(Float(0), 1 - z * z)), phi = 2 * Pi * u.y;
    return Frame::FromZ({x_[k], y_[k], z_[k]}).FromLocal({r * std::cos(phi), r * std::sin(phi), z});
}

Float GuideDirections::Pdf(const Vector3 &w) const {
    Lanes sums{};
    for (size_t k = 0; k < end_; k += kLanes)
        for (size_t i = 0; i < kLanes; ++i) {
            const Float cosine = w.x * x_[k + i] + w.y * y_[k + i] + w.z * z_[k + i];
            sums[i] += cosine >= cosine_[k + i] ? density_[k + i] : Float(0);
        }
    return SumOf(sums);
}

}  // namespace ext
