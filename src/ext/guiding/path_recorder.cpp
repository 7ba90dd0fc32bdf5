#include "ext/guiding/path_recorder.h"

#include <algorithm>

namespace ext {

void PathRecorder::SetSource(Float distance) {
    GuideRecord &record = bounces_[pendingBounces_ - 1].record;
    record.target = record.p + record.wi * distance;
    seeksSource_ = false;
}

void PathRecorder::Hit(const PathVertex &vertex) {
    if (!seeksSource_) return;
    way_ += Distance(at_, vertex.point.p);
    at_ = vertex.point.p;
    // Sources behind mirrors lie at the unfolded path length.
    const BxdfFlags flags = vertex.bsdf.Flags();
    if (IsNonSpecular(flags) || !IsSpecular(flags)) SetSource(way_);
}

void PathRecorder::AddBounce(const GuideRecord &record, const SampledSpectrum &L, const SampledSpectrum &beta) {
    seeksSource_ = true;
    way_ = 0;
    at_ = record.p;
    bounces_[pendingBounces_++] = {record, L, beta};
}

void PathRecorder::BeginVertex(const Point3 &p, uint32_t kind, const SampledSpectrum &beta, const SampledSpectrum &L) {
    const PendingVertex::Before here{L, beta.Average(), cost_};
    cost_ += PathCost::kLight;
    isPending_ = roulette_ && pendingVertices_ < vertices_.size() && here.beta > 0;
    if (isPending_) vertices_[pendingVertices_++] = {p, kind, here, {}};
}

void PathRecorder::BeginScattering(const SampledSpectrum &beta, const SampledSpectrum &L) {
    if (isPending_) {
        PendingVertex &v = vertices_[pendingVertices_ - 1];
        v.onwards = {L, beta.Average(), cost_};
        isPending_ = false;
    }
    cost_ += PathCost::kBounce;
}

void PathRecorder::End(const SampledSpectrum &L) {
    if (seeksSource_) SetSource(guide_.EnvironmentDistance());
    const auto inUnit = [&](const SampledSpectrum &radiance) { return radiance * guide_.PerRadianceUnit(); };
    for (size_t i = 0; i < pendingBounces_; ++i) {
        PendingBounce &open = bounces_[i];
        const SampledSpectrum added = inUnit(L - open.L);
        open.record.contribution = added.Average() / open.record.beta;
        open.record.radiance = SafeDivide(added, open.beta).Average();
        if (open.record.pdf > 0 && open.record.radiance >= 0 && open.record.contribution >= 0 &&
            std::isfinite(open.record.radiance * open.record.radiance / open.record.pdf) &&
            std::isfinite(open.record.contribution * open.record.contribution * open.record.pdf))
            guide_.Record(places_, open.record);
    }
    pendingBounces_ = 0;
    if (!roulette_) return;
    for (size_t i = 0; i < std::min(pendingVertices_, roulette_->Vertices()); ++i) {
        const PendingVertex &v = vertices_[i];
        const auto since = [&](const PendingVertex::Before &before) {
            return before.beta > 0
                       ? RouletteRecord::Segment{inUnit(L - before.L).Average() / before.beta, cost_ - before.cost}
                       : RouletteRecord::Segment{};
        };
        const RouletteRecord record{v.p, v.kind, since(v.here), since(v.onwards)};
        if (record.here.IsUsable() && record.onwards.IsUsable()) roulette_->Record(path_, i, record);
    }
    pendingVertices_ = 0;
    const Float radiance = inUnit(L).Average();
    if (std::isfinite(radiance * radiance)) roulette_->RecordPath(path_, {radiance, PathCost::kCamera + cost_});
}

}  // namespace ext
