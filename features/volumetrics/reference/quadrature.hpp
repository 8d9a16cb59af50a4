// Adaptive integration with an error estimate.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "features/volumetrics/reference/interval.hpp"

namespace tyndall::volumetrics::reference {

/// A value and a bound of its error, a channel each.
struct Estimate {
    glm::dvec3 value{0.0};
    glm::dvec3 error{0.0};

    Estimate& operator+=(const Estimate& other) {
        value += other.value;
        error += other.error;
        return *this;
    }
};

/// The error wanted is the larger of the two, judged by the largest channel.
struct Tolerance {
    double relative = 1e-6;
    double absolute = 0.0;
    std::size_t most_pieces = 20000; ///< into which one integral is cut before it returns what it has
};

[[nodiscard]] inline double largest(const glm::dvec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// Gauss and Kronrod's rules of 10 and 21 nodes on one piece (Piessens et al., QUADPACK, 1983). The error is twice
/// their difference: about that of the weaker rule, and none for polynomials of degree 19. At a kink both err alike.
template <class Integrand>
[[nodiscard]] Estimate gauss_kronrod(const Integrand& integrand, double begin, double end) {
    constexpr std::array nodes{0.995657163025808081, 0.973906528517171720, 0.930157491355708226, 0.865063366688984511,
                               0.780817726586416897, 0.679409568299024406, 0.562757134668604683, 0.433395394129247191,
                               0.294392862701460198, 0.148874338981631211};
    constexpr std::array kronrod{0.011694638867371874, 0.032558162307964727, 0.054755896574351996, 0.075039674810919953,
                                 0.093125454583697606, 0.109387158802297642, 0.123491976262065851, 0.134709217311473326,
                                 0.142775938577060081, 0.147739104901338491};
    constexpr double kronrod_middle = 0.149445554002916906;
    constexpr std::array gauss{0.066671344308688138, 0.149451349150580593, 0.219086362515982044, 0.269266719309996355,
                               0.295524224714752870};
    const double middle = 0.5 * (begin + end);
    const double half = 0.5 * (end - begin);
    glm::dvec3 fine = kronrod_middle * integrand(middle);
    glm::dvec3 coarse(0.0);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const glm::dvec3 pair = integrand(middle - half * nodes[i]) + integrand(middle + half * nodes[i]);
        fine += kronrod[i] * pair;
        if (i % 2 == 1) {
            coarse += gauss[i / 2] * pair;
        }
    }
    return {half * fine, 2.0 * glm::abs(half * (fine - coarse))};
}

/// Where to halve a piece: at the middle one of the seams in it, else in its middle. `seams` ascend.
[[nodiscard]] inline double place_to_halve(double begin, double end, std::span<const double> seams) {
    const auto first = std::upper_bound(seams.begin(), seams.end(), begin);
    const auto last = std::lower_bound(first, seams.end(), end);
    return first < last ? first[(last - first) / 2] : 0.5 * (begin + end);
}

/// Sum of the integrals of `integrand`, double to glm::dvec3, over `parts`, in each of which it is smooth but for a
/// jump of some derivative at `seams`. The worst piece is halved until the sum of errors is within `tolerance`.
template <class Integrand>
[[nodiscard]] Estimate integrate(const Integrand& integrand, std::span<const Interval> parts,
                                 const Tolerance& tolerance, std::span<const double> seams = {}) {
    struct Piece {
        double begin;
        double end;
        Estimate estimate;
        bool operator<(const Piece& other) const { return largest(estimate.error) < largest(other.estimate.error); }
    };
    std::vector<Piece> pieces;
    Estimate sum;
    for (const Interval& part : parts) {
        pieces.push_back({part.begin, part.end, gauss_kronrod(integrand, part.begin, part.end)});
        sum += pieces.back().estimate;
    }
    std::make_heap(pieces.begin(), pieces.end());
    while (!pieces.empty() && pieces.size() < tolerance.most_pieces) {
        const double wanted = std::max(tolerance.absolute, tolerance.relative * largest(glm::abs(sum.value)));
        const Piece worst = pieces.front();
        const double middle = place_to_halve(worst.begin, worst.end, seams);
        if (!(largest(sum.error) > wanted) || !(middle > worst.begin && middle < worst.end)) {
            break;
        }
        std::pop_heap(pieces.begin(), pieces.end());
        pieces.back() = {worst.begin, middle, gauss_kronrod(integrand, worst.begin, middle)};
        sum.value += pieces.back().estimate.value - worst.estimate.value;
        sum.error += pieces.back().estimate.error - worst.estimate.error;
        std::push_heap(pieces.begin(), pieces.end());
        pieces.push_back({middle, worst.end, gauss_kronrod(integrand, middle, worst.end)});
        sum += pieces.back().estimate;
        std::push_heap(pieces.begin(), pieces.end());
    }
    sum = {}; // anew: differences would leave the rounding of the largest error ever met
    for (const Piece& piece : pieces) {
        sum += piece.estimate;
    }
    return sum;
}

/// Appends `part`, cut at those of `breaks` that lie in it, each end mapped by `variable`, which ascends.
template <class Variable>
void append_cut(Interval part, std::vector<double> breaks, const Variable& variable, std::vector<Interval>& parts) {
    std::erase_if(breaks, [&](double t) { return !(t > part.begin && t < part.end); });
    breaks.push_back(part.end);
    std::sort(breaks.begin(), breaks.end());
    double begin = part.begin;
    for (const double end : breaks) {
        if (end > begin) {
            parts.push_back({variable(begin), variable(end)});
            begin = end;
        }
    }
}

} // namespace tyndall::volumetrics::reference
