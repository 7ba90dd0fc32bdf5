#include "pbrt/math/distributions.h"

#include <algorithm>
#include <bit>

#include "pbrt/core/error.h"

namespace pbrt {

PiecewiseConstant1D::PiecewiseConstant1D(std::span<const Float> f, Float low, Float high)
    : f_(f.begin(), f.end()), cdf_(f.size() + 1), low_(low), high_(high), last_(std::nextafter(high, low)) {
    PBRT_CHECK(!f.empty() && high > low);
    for (Float &v : f_) v = std::abs(v);
    double width = (double(high) - double(low)) / double(f.size()), sum = 0;
    std::vector<double> running(f.size() + 1, 0);
    for (size_t i = 0; i < f_.size(); ++i) running[i + 1] = sum += double(f_[i]) * width;
    integral_ = static_cast<Float>(sum);
    for (size_t i = 1; i < cdf_.size(); ++i)
        cdf_[i] = static_cast<Float>(sum > 0 ? running[i] / sum : double(i) / double(f_.size()));
    cdf_.back() = 1;

    constexpr size_t kPiecesPerCut = 8;
    const size_t cuts = std::bit_floor(std::max<size_t>(1, f_.size() / kPiecesPerCut));
    cuts_.resize(cuts + 1);
    size_t i = 0;
    for (size_t k = 0; k <= cuts; ++k) {
        const Float u = static_cast<Float>(k) / static_cast<Float>(cuts);
        while (i + 1 < f_.size() && cdf_[i + 1] <= u) ++i;
        cuts_[k] = static_cast<uint32_t>(i);
    }
}

PiecewiseConstant1D::Sampled PiecewiseConstant1D::Sample(Float u) const {
    // Last piece whose lower end is <= u; pieces of zero width are never chosen. Branchless: random u mispredicts every
    // second branch.
    const size_t cuts = cuts_.size() - 1;
    const size_t cut = std::min(static_cast<size_t>(u * static_cast<Float>(cuts)), cuts - 1);
    size_t i = cuts_[cut];
    for (size_t left = cuts_[cut + 1] - i + 1; left > 1;) {
        const size_t half = left / 2;
        i = cdf_[i + half] <= u ? i + half : i;
        left -= half;
    }
    Float width = cdf_[i + 1] - cdf_[i];
    Float t = width > 0 ? std::min((u - cdf_[i]) / width, OneMinusEpsilon) : 0;
    auto n = static_cast<Float>(f_.size());
    Float x = std::min(Lerp((static_cast<Float>(i) + t) / n, low_, high_), last_);
    Float pdf = integral_ > 0 ? f_[i] / integral_ : 1 / (high_ - low_);
    return {x, pdf, static_cast<int>(i)};
}

Float PiecewiseConstant1D::Pdf(Float x) const {
    if (x < low_ || x > high_) return 0;
    if (!(integral_ > 0)) return 1 / (high_ - low_);
    auto n = static_cast<Float>(f_.size());
    auto i = std::min(static_cast<size_t>((x - low_) / (high_ - low_) * n), f_.size() - 1);
    return f_[i] / integral_;
}

PiecewiseConstant2D::PiecewiseConstant2D(std::span<const Float> f, int nx, int ny, const Bounds2 &domain)
    : domain_(domain) {
    PBRT_CHECK(f.size() == static_cast<size_t>(nx) * static_cast<size_t>(ny));
    rows_.reserve(ny);
    std::vector<Float> integrals;
    for (int y = 0; y < ny; ++y) {
        rows_.emplace_back(f.subspan(static_cast<size_t>(y) * static_cast<size_t>(nx), static_cast<size_t>(nx)),
                           domain.low.x, domain.high.x);
        integrals.push_back(rows_.back().Integral());
    }
    marginal_ = PiecewiseConstant1D(integrals, domain.low.y, domain.high.y);
}

Point2 PiecewiseConstant2D::Sample(const Point2 &u, Float *pdf) const {
    PiecewiseConstant1D::Sampled y = marginal_.Sample(u.y);
    PiecewiseConstant1D::Sampled x = rows_[y.index].Sample(u.x);
    *pdf = x.pdf * y.pdf;
    return {x.x, y.x};
}

Float PiecewiseConstant2D::Pdf(const Point2 &p) const {
    Float t = (p.y - domain_.low.y) / (domain_.high.y - domain_.low.y);
    if (t < 0 || t > 1) return 0;
    auto row = std::min(static_cast<size_t>(t * static_cast<Float>(rows_.size())), rows_.size() - 1);
    return marginal_.Pdf(p.y) * rows_[row].Pdf(p.x);
}

AliasTable::AliasTable(std::span<const Float> weights) : bins_(weights.size()) {
    double sum = 0;
    for (Float w : weights) sum += double(w);
    size_t n = weights.size();
    std::vector<double> scaled(n);
    std::vector<int> under, over;
    for (size_t i = 0; i < n; ++i) {
        double p = sum > 0 ? double(weights[i]) / sum : 1.0 / double(n);
        bins_[i].p = static_cast<Float>(p);
        scaled[i] = p * double(n);
        (scaled[i] < 1 ? under : over).push_back(static_cast<int>(i));
    }
    while (!under.empty() && !over.empty()) {
        auto u = static_cast<size_t>(under.back()), o = static_cast<size_t>(over.back());
        under.pop_back();
        bins_[u].q = static_cast<Float>(scaled[u]);
        bins_[u].alias = static_cast<int>(o);
        scaled[o] -= 1 - scaled[u];
        if (scaled[o] < 1) {
            over.pop_back();
            under.push_back(static_cast<int>(o));
        }
    }
    // Entries left over by rounding own their whole column; those of weight 0 pass it to the heaviest entry.
    auto byWeight = [](const Bin &a, const Bin &b) { return a.p < b.p; };
    auto heaviest = static_cast<int>(std::max_element(bins_.begin(), bins_.end(), byWeight) - bins_.begin());
    for (const std::vector<int> *rest : {&under, &over})
        for (int i : *rest) {
            Bin &bin = bins_[i];
            bin.q = bin.p > 0 ? 1 : 0;
            bin.alias = heaviest;
        }
}

AliasTable::Sampled AliasTable::Sample(Float u) const {
    auto n = static_cast<Float>(bins_.size());
    auto column = std::min(static_cast<size_t>(u * n), bins_.size() - 1);
    Float up = std::min(u * n - static_cast<Float>(column), OneMinusEpsilon);
    const Bin &bin = bins_[column];
    if (up < bin.q) return {static_cast<int>(column), bin.p, std::min(up / bin.q, OneMinusEpsilon)};
    return {bin.alias, bins_[bin.alias].p, std::min((up - bin.q) / (1 - bin.q), OneMinusEpsilon)};
}

}  // namespace pbrt
