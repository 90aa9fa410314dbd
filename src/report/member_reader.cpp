#include "report/member_reader.h"

#include <limits>
#include <utility>

#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

using nlohmann::json;

MemberReader::MemberReader(const json& object, std::string file, std::string place)
    : object_(object), file_(std::move(file)), place_(std::move(place)) {
  if (!object.is_object()) throw Error(file_, place_, "must be an object");
}

void MemberReader::require(const char* name) const {
  if (!object_.contains(name)) throw Error(file_, placeOf(name), "is missing");
}

void MemberReader::read(const char* name, double& value) {
  if (const json* member = find(name)) value = number(*member, placeOf(name));
}

void MemberReader::read(const char* name, int& value) {
  const json* member = find(name);
  if (member == nullptr) return;
  // Of a number beyond an int's reach, get<int>() would keep the lowest bits.
  const bool fits = member->is_number_integer() && member->get<double>() >= std::numeric_limits<int>::min() &&
                    member->get<double>() <= std::numeric_limits<int>::max();
  if (!fits) throw Error(file_, placeOf(name), "must be a whole number");
  value = member->get<int>();
}

void MemberReader::read(const char* name, bool& value) {
  const json* member = find(name);
  if (member == nullptr) return;
  if (!member->is_boolean()) throw Error(file_, placeOf(name), "must be true or false");
  value = member->get<bool>();
}

void MemberReader::read(const char* name, std::string& value) {
  if (const json* member = find(name)) value = text(*member, placeOf(name));
}

void MemberReader::read(const char* name, std::vector<double>& values) {
  const json* member = findList(name);
  if (member == nullptr) return;
  values.clear();
  for (const json& item : *member) values.push_back(number(item, placeOf(name, values.size())));
}

void MemberReader::read(const char* name, std::vector<std::string>& values) {
  const json* member = findList(name);
  if (member == nullptr) return;
  values.clear();
  for (const json& item : *member) values.push_back(text(item, placeOf(name, values.size())));
}

void MemberReader::readRange(const char* name, double& least, double& greatest) {
  const json* member = find(name);
  if (member == nullptr) return;
  if (member->is_array() && member->size() == 2) {
    least = number((*member)[0], placeOf(name));
    greatest = number((*member)[1], placeOf(name));
  } else {
    least = greatest = number(*member, placeOf(name));
  }
}

void MemberReader::finish() const {
  for (const auto& item : object_.items()) {
    if (read_.count(item.key()) == 0) throw Error(file_, placeOf(item.key()), "is unknown");
  }
}

const json* MemberReader::find(const char* name) {
  read_.insert(name);
  const auto found = object_.find(name);
  return found == object_.end() ? nullptr : &*found;
}

const json* MemberReader::findList(const char* name) {
  const json* member = find(name);
  if (member != nullptr && !member->is_array()) throw Error(file_, placeOf(name), "must be a list");
  return member;
}

double MemberReader::number(const json& value, const std::string& place) const {
  if (!value.is_number()) throw Error(file_, place, "must be a number");
  return value.get<double>();
}

std::string MemberReader::text(const json& value, const std::string& place) const {
  if (!value.is_string()) throw Error(file_, place, "must be a text");
  return value.get<std::string>();
}

}  // namespace saw_ndt::internal
