#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace saw_ndt {

/// The members of an object as text, a line each: the name, then the value as JSON. Members of an object within it are
/// "name.member".
std::string figureLines(const nlohmann::ordered_json& figures);

}  // namespace saw_ndt
