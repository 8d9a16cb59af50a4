// A mistake in a declared frame, as data.
#pragma once

#include <cstdint>
#include <source_location>
#include <string>
#include <string_view>
#include <vector>

namespace tyndall::rg {

enum class DiagnosticCode : std::uint8_t {
    foreign_handle,          ///< a handle of another graph, of an earlier frame, or never initialised
    read_of_unwritten,       ///< nothing ever wrote the version that a pass reads
    two_writers,             ///< two passes write from the same version
    host_too_early,          ///< a host pass wants what the device has yet to do in the same frame
    cycle,                   ///< the data flow runs in a circle
    access_not_possible,     ///< the access does not fit the resource: an image as index buffer, a write of `sampled`
    queue_cannot,            ///< the pass kind or the queue asked for cannot do the access
    attachment_mismatch,     ///< attachments of one pass differ in size, layers or samples
    range_outside,           ///< mips, layers, aspects or bytes outside the resource
    import_incomplete,       ///< an import without final access, or with contradictory state
    duplicate_name,          ///< two passes or two resources share a name
    empty_pass,              ///< no access and no side effect
    conflicting_access,      ///< one pass touches the same range in two ways that no layout allows
    history_misuse,          ///< history of a resource that is never written, or written history
    bad_description,         ///< zero extent, unknown format, more mips than the extent has, zero bytes
    no_queue,                ///< the topology has no queue for the pass
    unknown_injection_point, ///< the host declared no point of that name
    plan_not_repeated,       ///< a shadow compile gave another plan; a mistake of this library, of none in the graph
    bad_file,                ///< a file that describes a frame, its costs or its plan says something impossible
};

[[nodiscard]] std::string_view name_of(DiagnosticCode code);

struct Diagnostic {
    DiagnosticCode code;
    std::string pass = {};                 ///< name, may be empty
    std::string resource = {};             ///< name, may be empty
    std::string message = {};              ///< one sentence that says what to change
    std::source_location where = {};       ///< the declaration at fault
    std::source_location other_where = {}; ///< the declaration that it clashes with; equals `where` if there is none
};

/// Never empty when it is returned as an error.
using Diagnostics = std::vector<Diagnostic>;

/// "file:line: code: message (see file:line)", one line; without places where there are none, as in a file's frame.
[[nodiscard]] std::string to_text(const Diagnostic& diagnostic);
[[nodiscard]] std::string to_text(const Diagnostics& diagnostics);

} // namespace tyndall::rg
