#include "ext/lab/measures.h"

#include <limits>

#include "pbrt/images/metrics.h"

namespace ext::lab {

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

MeasuringReference::MeasuringReference(Image reference)
    : reference_(std::move(reference)), flip_(std::make_unique<FlipReference>(reference_)) {}

Measures MeasuringReference::Compare(const Image &image) const {
    auto error = [&](Metric metric) { return ImageError(image, reference_, metric); };
    auto trimmed = [&](Metric metric) { return TrimmedRelL2(image, reference_, 0.001, nullptr, metric); };
    return {error(Metric::RelL2),   error(Metric::MSE),      error(Metric::MRSE),
            error(Metric::MAE),     error(Metric::SMAPE),    flip_->Compare(image),
            trimmed(Metric::RelL2), error(Metric::RelL2Abs), trimmed(Metric::RelL2Abs)};
}

}  // namespace ext::lab
