#include "ext/lab/measures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pbrt/math/statistics.h"

namespace ext::lab {

namespace {

/// P-value of `mean of b > mean of a` for pairs.
double PairedP(std::span<const double> a, std::span<const double> b) {
    RunningMoments difference;
    for (size_t i = 0; i < a.size(); ++i) difference.Add(b[i] - a[i]);
    if (difference.Variance() == 0) return 0;
    const double n = double(a.size());
    return StudentTwoSidedP(difference.Mean() / std::sqrt(difference.Variance() / n), n - 1) / 2;
}

/// The same for independent runs. Errors vary by factors, so their logarithms are nearly normal.
double WelchP(const Summary &a, const Summary &b) {
    auto logVariance = [](const Summary &s) { return s.standardError * s.standardError / (s.mean * s.mean); };
    const double va = logVariance(a), vb = logVariance(b), variance = va + vb;
    if (variance == 0) return 0;
    const double dof = variance * variance / (va * va / double(a.count - 1) + vb * vb / double(b.count - 1));
    return StudentTwoSidedP(std::log(b.mean / a.mean) / std::sqrt(variance), dof) / 2;
}

// Replaces increasing errors by the geometric mean of the violating points, until none increases.
void LevelRises(std::vector<CurvePoint> &points) {
    struct Block {
        double logSum;
        size_t count;
        double Mean() const { return logSum / double(count); }
    };
    std::vector<Block> blocks;
    for (const CurvePoint &p : points) {
        Block block{std::log(p.error), 1};
        for (; !blocks.empty() && blocks.back().Mean() < block.Mean(); blocks.pop_back()) {
            block.logSum += blocks.back().logSum;
            block.count += blocks.back().count;
        }
        blocks.push_back(block);
    }
    size_t i = 0;
    for (const Block &block : blocks)
        for (size_t k = 0; k < block.count; ++k, ++i)
            // Points that agree with their neighbours keep their exact error.
            if (block.count > 1) points[i].error = std::exp(block.Mean());
}

// y at x on the line through (x0, y0) and (x1, y1) in log-log.
double LogLog(double x, double x0, double y0, double x1, double y1) {
    const double t = std::log(x / x0) / std::log(x1 / x0);
    return y0 * std::pow(y1 / y0, t);
}

}  // namespace

Json ToJson(const Measures &measures) {
    Json json;
    for (size_t i = 0; i < MeasureCount; ++i) json[MeasureNames[i]] = measures[i];
    return json;
}

Measures MeasuresFromJson(const Json &json) {
    Measures measures;
    for (size_t i = 0; i < MeasureCount; ++i) {
        const Json &value = json.at(MeasureNames[i]);
        measures[i] = value.is_number() ? value.get<double>() : std::numeric_limits<double>::quiet_NaN();
    }
    return measures;
}

Measures MeasuringReference::Compare(const Image &image) const {
    auto error = [&](Metric metric) { return ImageError(image, reference_, metric); };
    auto trimmed = [&](Metric metric) { return TrimmedRelL2(image, reference_, 0.001, metric); };
    return {error(Metric::RelL2),   error(Metric::MSE),      error(Metric::MRSE),
            error(Metric::MAE),     error(Metric::SMAPE),    flip_.Compare(image),
            trimmed(Metric::RelL2), error(Metric::RelL2Abs), trimmed(Metric::RelL2Abs)};
}

Summary Summarize(std::span<const double> values) {
    RunningMoments moments;
    for (double v : values) moments.Add(v);
    const double stdDev = std::sqrt(moments.Variance()), n = double(moments.Count());
    return {moments.Count(), moments.Mean(), stdDev, n > 1 ? stdDev / std::sqrt(n) : 0};
}

bool LowerBeyondNoise(std::span<const double> a, std::span<const double> b, double level) {
    const Summary sa = Summarize(a), sb = Summarize(b);
    if (sa.count < 2 || sb.count < 2 || !(sa.mean < sb.mean)) return false;
    if (sa.mean <= 0) return true;
    const bool paired = sa.count == sb.count && sa.count >= kSeedsToPair;
    return (paired ? PairedP(a, b) : WelchP(sa, sb)) < level;
}

ErrorCurve::ErrorCurve(std::vector<CurvePoint> points, double fixedCost) : fixedCost_(fixedCost) {
    for (const CurvePoint &p : points)
        if (std::isfinite(p.cost) && std::isfinite(p.error) && p.cost > 0 && p.error > 0) points_.push_back(p);
    std::ranges::sort(points_, {}, &CurvePoint::cost);
    LevelRises(points_);
    if (!points_.empty()) fixedCost_ = std::clamp(fixedCost_, 0.0, points_.back().cost);
}

std::optional<double> ErrorCurve::ErrorAt(double cost) const {
    if (points_.empty() || !(cost >= points_.front().cost)) return {};
    const CurvePoint &last = points_.back();
    if (cost > last.cost) return last.error * (last.cost - fixedCost_) / (cost - fixedCost_);
    const auto next = std::ranges::lower_bound(points_, cost, {}, &CurvePoint::cost);
    if (next->cost == cost) return next->error;
    const CurvePoint &before = *std::prev(next);
    return LogLog(cost, before.cost, before.error, next->cost, next->error);
}

std::optional<double> ErrorCurve::CostToReach(double error) const {
    if (points_.empty() || !(error > 0) || points_.front().error < error) return {};
    const CurvePoint &last = points_.back();
    if (last.error > error) return fixedCost_ + (last.cost - fixedCost_) * (last.error / error);
    const auto reached = std::ranges::find_if(
        points_, [=](double e) { return e <= error; }, &CurvePoint::error);
    if (reached->error == error) return reached->cost;
    const CurvePoint &before = *std::prev(reached);
    return LogLog(error, before.error, before.cost, reached->error, reached->cost);
}

std::vector<CurvePoint> MeanCurve(std::span<const std::vector<CurvePoint>> runs) {
    std::vector<CurvePoint> mean;
    if (runs.empty()) return mean;
    const size_t length = std::ranges::min_element(runs, {}, std::ranges::size)->size();
    const auto n = double(runs.size());
    for (size_t i = 0; i < length; ++i) {
        CurvePoint p;
        for (const auto &run : runs) {
            p.cost += run[i].cost / n;
            p.error += run[i].error / n;
        }
        mean.push_back(p);
    }
    return mean;
}

std::optional<double> SpeedUpToEqualError(const ErrorCurve &mine, const ErrorCurve &other) {
    if (mine.Points().empty() || other.Points().empty()) return {};
    const CurvePoint &last = mine.Points().back();
    if (auto needed = other.CostToReach(last.error)) return *needed / last.cost;
    const CurvePoint &first = other.Points().front();
    auto needed = mine.CostToReach(first.error);
    if (!needed) return {};
    return first.cost / *needed;
}

std::optional<double> ErrorRatioAtEqualCost(const ErrorCurve &mine, const ErrorCurve &other) {
    if (mine.Points().empty() || other.Points().empty()) return {};
    const double cost = std::min(mine.Points().back().cost, other.Points().back().cost);
    auto a = mine.ErrorAt(cost), b = other.ErrorAt(cost);
    if (!a || !b) return {};
    return *a / *b;
}

}  // namespace ext::lab
