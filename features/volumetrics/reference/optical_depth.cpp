#include "features/volumetrics/reference/optical_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <glm/common.hpp>

namespace tyndall::volumetrics::reference {
namespace {

constexpr double nothing_left = 45.0;

double smallest(const glm::dvec3& v) {
    return std::min({v.x, v.y, v.z});
}

constexpr int every_channel = -1;

/// Where the optical depth without noise first reaches `depth` in a channel, or in every channel that it ever grows in;
/// `limit` if it does not before.
double distance_at_depth(const Fog& fog, const Ray& ray, double depth, double limit, int channel = every_channel) {
    const glm::dvec3 whole = fog.closed_optical_depth(ray, limit);
    const auto reached = [&](double distance_m) {
        glm::dvec3 here = fog.closed_optical_depth(ray, distance_m);
        for (int c = 0; c < 3; ++c) {
            here[c] = whole[c] > 0.0 ? here[c] : largest(here);
        }
        return (channel == every_channel ? smallest(here) : here[channel]) >= depth;
    };
    double far = 1e-9;
    while (far < limit && !reached(far)) {
        far *= 2.0;
    }
    if (far >= limit && !reached(limit)) {
        return limit;
    }
    far = std::min(far, limit);
    double near = 0.0;
    for (int i = 0; i < 30; ++i) { // a place to cut at, of which no exactness is wanted
        const double middle = 0.5 * (near + far);
        (reached(middle) ? far : near) = middle;
    }
    return far;
}

template <class Extinction>
Estimate summed(const Fog& fog, const Ray& ray, double length_m, double wanted, const Extinction& extinction) {
    std::vector<double> breaks;
    std::vector<double> seams;
    fog.add_breaks(ray, {0.0, length_m}, breaks);
    fog.add_seams(ray, {0.0, length_m}, seams);
    std::sort(seams.begin(), seams.end());
    std::vector<Interval> parts;
    append_cut({0.0, length_m}, std::move(breaks), std::identity(), parts);
    return integrate(extinction, parts, {0.0, wanted}, seams);
}

/// Gauss and Legendre's nodes and weights on [-1, 1], by Newton's iteration, and the polynomials' values there.
template <std::size_t count>
struct GaussLegendre {
    std::array<double, count> node{};
    std::array<double, count> weight{};
    std::array<std::array<double, count>, count> polynomial{}; ///< [degree][node]

    GaussLegendre() {
        constexpr auto n = static_cast<double>(count);
        for (std::size_t i = 0; i < count; ++i) {
            double x = std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) / (n + 0.5));
            double slope = 1.0;
            for (int iteration = 0; iteration < 8; ++iteration) {
                double before = 1.0;
                double here = x;
                for (std::size_t k = 2; k <= count; ++k) {
                    const auto d = static_cast<double>(k);
                    const double next = ((2.0 * d - 1.0) * x * here - (d - 1.0) * before) / d;
                    before = here;
                    here = next;
                }
                slope = n * (x * here - before) / (x * x - 1.0);
                x -= here / slope;
            }
            node[i] = x;
            weight[i] = 2.0 / ((1.0 - x * x) * slope * slope);
            polynomial[0][i] = 1.0;
            polynomial[1][i] = x;
            for (std::size_t k = 2; k < count; ++k) {
                const auto d = static_cast<double>(k);
                polynomial[k][i] = ((2.0 * d - 1.0) * x * polynomial[k - 1][i] - (d - 1.0) * polynomial[k - 2][i]) / d;
            }
        }
    }
};

} // namespace

Estimate optical_depth(const Fog& fog, const Ray& ray, double length_m, double wanted) {
    if (fog.is_closed()) {
        return {fog.closed_optical_depth(ray, length_m), glm::dvec3(0.0)};
    }
    return summed(fog, ray, length_m, wanted, [&](double t) { return fog.at(point_at(ray, t)).extinction; });
}

Estimate optical_depth_of_sky(const Fog& fog, const Ray& ray, double wanted) {
    if (fog.is_closed()) {
        return {fog.closed_optical_depth_of_sky(ray), glm::dvec3(0.0)};
    }
    const double end_m = fog.end_of_ending(ray);
    if (!(end_m > 0.0)) {
        return {};
    }
    return summed(fog, ray, end_m, wanted,
                  [&](double t) { return fog.ending_at(point_at(ray, t), ray.direction).extinction; });
}

EyePath::EyePath(const Fog& fog, const Ray& ray, double length_m, double wanted) : fog_(fog), ray_(ray) {
    double limit_m = length_m;
    limit_m = std::min(limit_m, fog.end_along(ray));
    // Noise may keep the density below its mean for a while: then farther.
    double begin_m = 0.0;
    for (double depth = nothing_left; limit_m > begin_m && depth < 1e6; depth *= 2.0) {
        end_m_ = distance_at_depth(fog, ray, depth, limit_m);
        if (fog.is_closed()) {
            break;
        }
        follow(begin_m, end_m_, wanted);
        if (smallest(optical_depth(end_m_)) >= nothing_left) {
            break;
        }
        begin_m = end_m_;
    }
    for (double level = 0.5; level < nothing_left; level *= 2.0) {
        for (int channel = 0; channel < 3; ++channel) {
            const double distance_m = distance_at_depth(fog, ray, level, end_m_, channel);
            if (distance_m < end_m_ && (breaks_.empty() || distance_m != breaks_.back())) {
                breaks_.push_back(distance_m);
            }
        }
    }
    fog.add_breaks(ray, {0.0, end_m_}, breaks_);
    std::sort(breaks_.begin(), breaks_.end());
}

void EyePath::follow(double begin, double end, double wanted) {
    std::vector<double> cuts;
    fog_.add_breaks(ray_, {begin, end}, cuts);
    const std::size_t known = seams_.size();
    fog_.add_seams(ray_, {begin, end}, seams_);
    std::sort(seams_.begin() + static_cast<std::ptrdiff_t>(known), seams_.end());
    cuts.insert(cuts.end(), seams_.begin() + static_cast<std::ptrdiff_t>(known), seams_.end());
    std::vector<Interval> parts;
    append_cut({begin, end}, std::move(cuts), std::identity(), parts);
    for (const Interval& part : parts) {
        expand(part.begin, part.end, wanted / static_cast<double>(parts.size()), 20);
    }
}

void EyePath::expand(double begin, double end, double wanted, int halvings) {
    static const GaussLegendre<terms> rule;
    Piece piece{begin, end, glm::dvec3(0.0), {}};
    for (std::size_t i = 0; i < terms; ++i) {
        const double distance_m = 0.5 * (begin + end) + 0.5 * (end - begin) * rule.node[i];
        const glm::dvec3 weighted = rule.weight[i] * fog_.at(point_at(ray_, distance_m)).extinction;
        for (std::size_t k = 0; k < terms; ++k) {
            piece.coefficients[k] += (static_cast<double>(k) + 0.5) * rule.polynomial[k][i] * weighted;
        }
    }
    const double tail = largest(glm::abs(piece.coefficients[terms - 2]) + glm::abs(piece.coefficients[terms - 1]));
    const double error = tail * (end - begin) / static_cast<double>(terms);
    if (error > wanted && halvings > 0) {
        const double middle = 0.5 * (begin + end);
        expand(begin, middle, 0.5 * wanted, halvings - 1);
        expand(middle, end, 0.5 * wanted, halvings - 1);
        return;
    }
    error_ += error;
    if (!pieces_.empty()) {
        const Piece& last = pieces_.back();
        piece.before = last.before + last.coefficients[0] * (last.end - last.begin);
    }
    pieces_.push_back(piece);
}

glm::dvec3 EyePath::optical_depth(double distance_m) const {
    if (pieces_.empty()) {
        return fog_.closed_optical_depth(ray_, distance_m);
    }
    const auto after = std::upper_bound(pieces_.begin() + 1, pieces_.end(), distance_m,
                                        [](double t, const Piece& piece) { return t < piece.begin; });
    const Piece& piece = *(after - 1);
    // The integral of P_k from -1 is (P_{k+1} - P_{k-1}) / (2 k + 1), of P_0 it is x + 1.
    const double half = 0.5 * (piece.end - piece.begin);
    const double x = (distance_m - piece.begin) / half - 1.0;
    glm::dvec3 sum = piece.coefficients[0] * (x + 1.0);
    double before = 1.0;
    double here = x;
    for (std::size_t k = 1; k < terms; ++k) {
        const auto d = static_cast<double>(k);
        const double next = ((2.0 * d + 1.0) * x * here - d * before) / (d + 1.0);
        sum += piece.coefficients[k] * ((next - before) / (2.0 * d + 1.0));
        before = here;
        here = next;
    }
    return piece.before + half * sum;
}

} // namespace tyndall::volumetrics::reference
