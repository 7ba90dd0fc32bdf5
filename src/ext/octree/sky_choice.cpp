#include "ext/octree/sky_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pbrt/core/parallel.h"
#include "pbrt/lights/light_spectrum.h"
#include "pbrt/math/low_discrepancy.h"
#include "pbrt/math/rng.h"

namespace ext {

namespace {

constexpr size_t kLanes = SkyCells::kLanes;
constexpr size_t kChunk = 256;
/// Whether more of the skies is seen than tiles pay for is asked first at 2^kFewestVertexBits to 2^kMostVertexBits of
/// the vertices, at most half of them, and believed if it is sure by kSure standard errors.
constexpr int kFewestVertexBits = 6, kMostVertexBits = 10;
constexpr double kSure = 4;
constexpr uint64_t kStream = 0x736b79;
/// If a smaller share of the rays leaves the scene, choosing tiles cannot be worth its time.
constexpr double kHardlySeen = 0.01;

/// Writes G (sqrt(v) + c) of the tiles of some packets and its sums over packets, and returns the sum over all; see
/// SkyChoice. The same bits wherever it is called from.
[[gnu::noinline]] Float WeighTiles(const SkyCells::Packet *packets, size_t count, const LightQuery &query, Float *w,
                                   Float *sums) {
    using Ops = SimdOps<kLanes>;
    using F = Ops::F;
    auto load = [](const Float *v) { return F(v, std::experimental::vector_aligned); };
    const bool inMedium = query.ns == Normal3(0);
    const Normal3 n = query.ns * (Dot(query.wo, query.ns) < 0 ? Float(-1) : Float(1));
    const F nx(n.x), ny(n.y), nz(n.z), otherSide(query.transmits ? Float(-1) : Float(1));
    Float sum = 0;
    for (size_t i = 0; i < count; ++i) {
        const SkyCells::Packet &p = packets[i];
        F value = load(p.weight);
        if (!inMedium) {
            F c = nx * load(p.x) + ny * load(p.y) + nz * load(p.z);
            c = Ops::Max(c, c * otherSide);
            const F s = load(p.sine), above = Ops::Max(c + s, F(0));
            value *= Ops::Select(c >= s, c, above * above * load(p.quarterInvSine));
        }
        value.copy_to(w + i * kLanes, std::experimental::vector_aligned);
        sum += sums[i] = std::experimental::reduce(value);
    }
    return sum;
}

/// The sum of the tiles [begin, end) of a row, given the sums over its packets. 0 if all of them are 0.
Float SumOver(const Float *tiles, const Float *packets, size_t begin, size_t end) {
    Float sum = 0;
    for (; begin < end && begin % kLanes != 0; ++begin) sum += tiles[begin];
    for (; begin + kLanes <= end; begin += kLanes) sum += packets[begin / kLanes];
    for (; begin < end; ++begin) sum += tiles[begin];
    return sum;
}

}  // namespace

SkyChoice::SkyChoice(const LightTable &lights, const SkyCells::Settings &settings)
    : lights_(lights), settings_(settings) {
    for (size_t i = 0; i < lights.Skies().size() && Count() < kMaxSkies; ++i) {
        SkyTiles tiles(lights, i);
        if (tiles.IsBlack()) continue;
        const LightId sky = tiles.Sky();
        skies_.push_back(std::move(tiles));
        wholeIsSampled_.push_back(MakeEmitter(lights, sky, lights.Candidate(sky)).m0 > 0);
    }
}

std::vector<LightId> SkyChoice::PartsOf(size_t k) const {
    std::vector<uint32_t> numbers;
    for (uint32_t c = 0; c < cells_.CellCount(); ++c) {
        const SkyCells::Row &row = cells_.RowOf(c);
        for (size_t lane = row.first[k] * kLanes; lane < row.first[k + 1] * kLanes; ++lane)
            if (cells_.Number(lane) > 0) numbers.push_back(cells_.Number(lane));
    }
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
    std::vector<LightId> ids;
    for (uint32_t n : numbers) ids.push_back(skies_[k].IdOf(n));
    return ids;
}

const SkyParts::Weights *SkyChoice::Weigh(const LightQuery &query, LightMemory &memory) const {
    auto *weights = memory.Make<AtVertex>();
    weights->row = cells_.IsEmpty() ? nullptr : &cells_.RowOf(cells_.CellAt(query.p));
    weights->isOpen = !weights->row || weights->row->isOpen;
    if (weights->isOpen) {
        for (size_t k = 0; k < Count(); ++k)
            weights->g[k] = weights->w[k] = wholeIsSampled_[k] ? skies_[k].Unoccluded(query) : Float(0);
        return weights;
    }
    const SkyCells::Row &row = *weights->row;
    const size_t packets = row.first[Count()] - row.first[0];
    auto *w = memory.Make<Float>(packets * kLanes), *sums = memory.Make<Float>(packets);
    for (size_t k = 0; k < Count(); ++k) {
        const size_t begin = row.first[k] - row.first[0], end = row.first[k + 1] - row.first[0];
        const Float sum =
            WeighTiles(cells_.Packets() + row.first[k], end - begin, query, w + begin * kLanes, sums + begin);
        weights->w[k] = sum;
        weights->g[k] = sum > 0 ? skies_[k].Unoccluded(query) : Float(0);
        weights->perSum[k] = sum > 0 ? 1 / sum : 0;
    }
    weights->tiles = w;
    weights->packets = sums;
    return weights;
}

std::optional<SampledLight> SkyChoice::Sample(const Weights &known, size_t k, Point2 *u) const {
    const auto &weights = static_cast<const AtVertex &>(known);
    if (weights.isOpen) return SampledLight{skies_[k].Sky(), 1};
    const SkyCells::Row &row = *weights.row;
    const size_t firstPacket = row.first[k] - row.first[0], firstLane = row.first[k] * kLanes;
    const Float *tiles = weights.tiles + firstPacket * kLanes, *packets = weights.packets + firstPacket;
    size_t node = 0, first = 0;
    for (size_t count = row.tiles[k], axis = 1; count > 1; axis ^= 1) {
        const size_t inFirst = cells_.TilesInFirstHalf(firstLane, node);
        const Float one = SumOver(tiles, packets, first, first + inFirst);
        const Float other = SumOver(tiles, packets, first + inFirst, first + count);
        const Float p = one / (one + other);
        Float &v = axis == 0 ? u->x : u->y;
        if (v < p) {
            v = std::min(v / p, OneMinusEpsilon);
            count = inFirst;
            node += 1;
        } else {
            v = std::clamp((v - p) / (1 - p), Float(0), OneMinusEpsilon);
            first += inFirst;
            count -= inFirst;
            node += inFirst;
        }
    }
    if (!(tiles[first] > 0)) return {};
    return SampledLight{skies_[k].IdOf(cells_.Number(firstLane + first)), tiles[first] * weights.perSum[k]};
}

Float SkyChoice::PMF(const Weights &known, size_t k, LightId light) const {
    const auto &weights = static_cast<const AtVertex &>(known);
    if (!lights_.IsTile(light)) return weights.isOpen ? 1 : 0;
    if (weights.isOpen) return 0;
    const uint32_t number = lights_.NumberOf(light);
    const size_t lane = cells_.LaneOf(*weights.row, k, SkyTiles::KeyOf(number));
    if (cells_.Number(lane) != number) return 0;
    return weights.tiles[lane - weights.row->first[0] * kLanes] * weights.perSum[k];
}

LightId SkyChoice::PartTowards(const Weights &known, size_t k, const Point3 &, const Vector3 &d) const {
    const auto &weights = static_cast<const AtVertex &>(known);
    if (weights.isOpen) return skies_[k].Sky();
    return skies_[k].IdOf(cells_.Number(cells_.LaneOf(*weights.row, k, skies_[k].KeyTowards(d))));
}

void SkyChoice::Count(const Point3 &p, const Vector3 &d, bool left) const {
    if (cells_.IsEmpty()) return;
    const SkyCells::Row &row = cells_.RowOf(cells_.CellAt(p));
    for (size_t k = 0; k < Count(); ++k) cells_.Count(cells_.LaneOf(row, k, skies_[k].KeyTowards(d)), left);
}

SkyCells SkyChoice::MakeCells(const Bounds3 &bounds, float visible) {
    std::vector<std::vector<uint32_t>> cuts;
    for (SkyTiles &sky : skies_) cuts.push_back(sky.FirstCut(settings_.tiles));
    SkyCells cells(bounds, cuts, visible, settings_);
    cells.Learn(skies_, false);
    return cells;
}

void SkyChoice::LookFrom(const PrepareContext &context, std::span<const PrepassVertex> vertices, int64_t i, int side,
                         std::vector<SkyLook> *looks) const {
    const PrepassVertex &vertex = vertices[static_cast<size_t>(i)];
    LightMemory memory;
    const Weights &weights = *Weigh(QueryAt(vertex), memory);
    Rng rng(Hash(kStream, context.seed, i));
    for (size_t k = 0; k < Count(); ++k)
        for (int t = 0; t < side * side; ++t) {
            Point2 u = (Point2(t % side, t / side) + rng.Uniform2()) / static_cast<Float>(side);
            const std::optional<SampledLight> tile = Sample(weights, k, &u);
            if (!tile) continue;
            std::optional<LightLiSample> s =
                lights_[tile->light].SampleLi(vertex.at, u, SampledWavelengths::WholeRange(), true);
            if (!s) continue;
            const Float cosine = Dot(s->wi, vertex.at.ns);
            if (vertex.at.ns != Normal3(0) && !vertex.transmits && cosine * Dot(vertex.wo, vertex.at.ns) <= 0) continue;
            looks->push_back({vertex.at.p, s->wi, !context.scene.Occluded(vertex.at, *s)});
        }
}

bool SkyChoice::SeesMoreThan(double most, const PrepareContext &context, std::span<const PrepassVertex> vertices,
                             int side) {
    const int bits = std::min(static_cast<int>(std::bit_width(vertices.size() / 2)) - 1, kMostVertexBits);
    if (bits < kFewestVertexBits || most >= 1) return false;
    ForgetAll(context);
    const uint64_t first = uint64_t{1} << bits;
    // Rays of one vertex see much the same, so the vertices tell how sure the share is.
    double looked = 0, left = 0, looked2 = 0, left2 = 0, both = 0;
    std::vector<SkyLook> looks;
    for (uint64_t i = 0; i < first; ++i) {
        // Neighbours in the picture follow each other among the vertices, so the picture is halved again and again.
        const uint64_t at = ReverseBits32(static_cast<uint32_t>(i)) >> (32 - bits);
        looks.clear();
        LookFrom(context, vertices, static_cast<int64_t>(at * vertices.size() / first), side, &looks);
        const auto n = static_cast<double>(looks.size());
        const auto seen =
            static_cast<double>(std::ranges::count_if(looks, [](const SkyLook &look) { return look.left; }));
        looked += n, left += seen, looked2 += n * n, left2 += seen * seen, both += n * seen;
        if (i + 1 < (uint64_t{1} << kFewestVertexBits) || !std::has_single_bit(i + 1) || !(looked > 0)) continue;
        seenShare_ = left / looked;
        const double variance = left2 - 2 * seenShare_ * both + seenShare_ * seenShare_ * looked2;
        if (seenShare_ - kSure * std::sqrt(std::max(variance, 0.0)) / looked > most) return true;
    }
    return false;
}

std::vector<SkyLook> SkyChoice::Look(PrepareContext &context, std::span<const PrepassVertex> vertices, int side,
                                     size_t count) {
    ForgetAll(context);
    const auto chunks = static_cast<int64_t>((count + kChunk - 1) / kChunk);
    std::vector<std::vector<SkyLook>> ofChunk(static_cast<size_t>(chunks));
    context.progress.BeginPhase("looking at the sky", chunks);
    ParallelForEach(chunks, [&](int64_t chunk) {
        if (context.progress.Cancelled()) return;
        const auto first = static_cast<size_t>(chunk) * kChunk;
        for (size_t i = first; i < std::min(first + kChunk, count); ++i)
            LookFrom(context, vertices, static_cast<int64_t>(i * vertices.size() / count), side,
                     &ofChunk[static_cast<size_t>(chunk)]);
        context.progress.Advance();
    });
    context.progress.EndPhase();
    std::vector<SkyLook> looks;
    for (std::vector<SkyLook> &some : ofChunk) {
        looks.insert(looks.end(), some.begin(), some.end());
        some = {};
    }
    const auto left = std::ranges::count_if(looks, [](const SkyLook &look) { return look.left; });
    seenShare_ = static_cast<double>(left) / static_cast<double>(std::max<size_t>(looks.size(), 1));
    return looks;
}

void SkyChoice::LookAround(PrepareContext &context, std::span<const PrepassVertex> vertices, int side) {
    const std::vector<SkyLook> looks = Look(context, vertices, side, vertices.size());
    if (context.progress.Cancelled()) return;
    const auto left = static_cast<float>(std::ranges::count_if(looks, [](const SkyLook &look) { return look.left; }));
    const auto countAll = [&] {
        for (const SkyLook &look : looks) Count(look.p, look.d, look.left);
    };
    // First one cell for the whole scene, from which the others inherit.
    const Bounds3 bounds = context.scene.Bounds();
    cells_ = MakeCells(bounds, (left + 1) / (static_cast<float>(looks.size()) + 2));
    countAll();
    cells_.Learn(skies_, false);
    std::vector<Point3> points;
    points.reserve(vertices.size());
    for (const PrepassVertex &vertex : vertices) points.push_back(vertex.at.p);
    cells_.DivideAround(points, skies_);
    countAll();
    Learn(false);
}

void SkyChoice::Learn(bool judges) {
    if (cells_.IsEmpty()) return;
    cells_.Learn(skies_, true);
    if (judges && static_cast<double>(cells_.Left()) < kHardlySeen * static_cast<double>(cells_.Traced())) cells_ = {};
}

void SkyChoice::Report(nlohmann::ordered_json &report) const {
    report["skyCells"] = cells_.CellCount();
    report["skyTilesPerCell"] =
        static_cast<double>(cells_.TileCount()) / static_cast<double>(std::max<size_t>(cells_.CellCount(), 1));
    report["skyOpenCells"] = cells_.OpenShare();
    report["skyRays"] = cells_.Traced();
    report["skyRaysLeft"] = cells_.Left();
    report["skyBytes"] = Bytes();
}

void SkyChoice::Inspect(const Point3 &p, std::vector<InspectedValue> &values) const {
    const bool learned = !cells_.IsEmpty();
    const uint32_t cell = learned ? cells_.CellAt(p) : 0;
    values.push_back({"sky cell", static_cast<double>(cell), true});
    for (size_t k = 0; k < Count(); ++k)
        values.push_back(
            {fmt::format("sky {} seen", k), learned ? static_cast<double>(cells_.Visible(cell, k)) : 1.0, false});
}

std::string SkyChoice::Describe() const {
    return fmt::format(
        "cells that know what they see of the sky: {}, with {} tiles; {:.1f} % of them see nearly all of it\n"
        "rays counted: {}, of which left the scene: {}\n",
        cells_.CellCount(), cells_.TileCount(), 100 * cells_.OpenShare(), cells_.Traced(), cells_.Left());
}

size_t SkyChoice::Bytes() const {
    size_t bytes = cells_.Bytes();
    for (const SkyTiles &sky : skies_) bytes += sky.Bytes();
    return bytes;
}

}  // namespace ext
