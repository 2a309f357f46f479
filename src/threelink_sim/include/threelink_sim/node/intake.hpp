/// @file
/// Reception of messages and service calls: the memory of each is bounded by its length whoever
/// sends it, and malformed messages are counted and logged at a limited rate.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <utility>

#include <boost/make_shared.hpp>
#include <ros/node_handle.h>

#include "threelink_sim/node/allocation_limit.hpp"
#include "threelink_sim/node/diagnostics.hpp"
#include "threelink_sim/node/peer_types.hpp"
#include "threelink_sim/node/quiet_log.hpp"

namespace threelink_sim {

/// Largest sizes of messages [bytes].
namespace message_size {
constexpr std::size_t kSmall = std::size_t{1} << 20;   ///< states, observations, rates, texts
constexpr std::size_t kFile = std::size_t{64} << 20;   ///< policies
constexpr std::size_t kArrays = std::size_t{1} << 30;  ///< batches of episodes; roscpp's limit
}  // namespace message_size

/// The filter of a topic or a service. Refusals are counted as "NAME refused: malformed" if there
/// are diagnostics.
class Intake {
 public:
  Intake(const std::string& name, std::size_t most_bytes, Diagnostics* diagnostics)
      : name_(name),
        most_bytes_(most_bytes),
        malformed_(diagnostics ? &diagnostics->refusals(name + " refused: malformed") : nullptr) {}

  /// Calls read(), which deserialises `bytes` bytes of a sender. Returns false if they are refused.
  template <class Read>
  bool take(std::size_t bytes, const boost::shared_ptr<ros::M_string>& header, Read read) {
    if (bytes > most_bytes_) {
      refuse(bytes, header, "too long");
      return false;
    }
    try {
      const AllocationLimit limit(kTimes * bytes + kAlways);
      read();
      return true;
    } catch (const std::exception& error) {
      refuse(bytes, header, error.what());
      return false;
    }
  }

 private:
  /// [bytes] An array in memory is at most kTimes as large as its bytes in the message: the
  /// smallest element there, the length of an empty string, has 4 bytes, and the largest structure
  /// of threelink_msgs has 400.
  static constexpr std::size_t kTimes = 100, kAlways = 4096;

  void refuse(std::size_t bytes, const boost::shared_ptr<ros::M_string>& header,
              const char* reason);

  std::string name_;
  std::size_t most_bytes_;
  Diagnostics::Counter* malformed_;
  QuietLog log_;
};

/// Deserialises the messages of a topic through an Intake.
template <class Message>
class IntakeOfTopic
    : public ros::SubscriptionCallbackHelperT<const ros::MessageEvent<Message const>&> {
  using Base = ros::SubscriptionCallbackHelperT<const ros::MessageEvent<Message const>&>;

 public:
  IntakeOfTopic(const typename Base::Callback& callback, const std::string& topic,
                std::size_t most_bytes, Diagnostics* diagnostics)
      : Base(callback), intake_(topic, most_bytes, diagnostics) {}

  ros::VoidConstPtr deserialize(
      const ros::SubscriptionCallbackHelperDeserializeParams& params) override {
    ros::VoidConstPtr message;
    intake_.take(params.length, params.connection_header,
                 [&] { message = Base::deserialize(params); });
    return message;
  }

 private:
  Intake intake_;
};

/// Deserialises the requests of a service through an Intake.
template <class Service>
class IntakeOfService : public ros::ServiceCallbackHelper {
 public:
  using Event = ros::ServiceEvent<typename Service::Request, typename Service::Response>;
  using Callback = std::function<void(Event&)>;

  IntakeOfService(Callback callback, const std::string& name, std::size_t most_bytes,
                  Diagnostics* diagnostics)
      : callback_(std::move(callback)), intake_(name, most_bytes, diagnostics) {}

  bool call(ros::ServiceCallbackHelperCallParams& params) override {
    const auto request = boost::make_shared<typename Service::Request>();
    const auto response = boost::make_shared<typename Service::Response>();
    const bool good = intake_.take(params.request.num_bytes, params.connection_header, [&] {
      ros::serialization::deserializeMessage(params.request, *request);
    });
    if (good) {
      Event event(request, response, params.connection_header);
      callback_(event);
    }
    params.response = ros::serialization::serializeServiceResponse(good, *response);
    return good;
  }

 private:
  Callback callback_;
  Intake intake_;
};

/// Subscribes like the method of the node handle, in whose queue the callbacks run. `diagnostics`,
/// if not null, must outlive the subscriber. Publishers with another type are reported
/// (peer_types.hpp).
template <class Message>
ros::Subscriber subscribe(ros::NodeHandle& node, const std::string& topic, std::uint32_t queue,
                          std::size_t most_bytes, Diagnostics* diagnostics,
                          const std::function<void(const ros::MessageEvent<Message const>&)>& heard,
                          const ros::TransportHints& hints = ros::TransportHints().tcpNoDelay()) {
  ros::SubscribeOptions options;
  options.topic = topic;
  options.queue_size = queue;
  options.datatype = ros::message_traits::datatype<Message>();
  options.md5sum = ros::message_traits::md5sum<Message>();
  options.helper =
      boost::make_shared<IntakeOfTopic<Message>>(heard, topic, most_bytes, diagnostics);
  options.transport_hints = hints;
  expect_type(node.resolveName(topic), {options.datatype, options.md5sum});
  return node.subscribe(options);
}

/// Advertises a service like the method of the node handle. `diagnostics`, if not null, must
/// outlive the server.
template <class Service>
ros::ServiceServer advertise_service(ros::NodeHandle& node, const std::string& name,
                                     std::size_t most_bytes, Diagnostics* diagnostics,
                                     typename IntakeOfService<Service>::Callback callback) {
  ros::AdvertiseServiceOptions options;
  options.service = name;
  options.datatype = ros::service_traits::datatype<Service>();
  options.md5sum = ros::service_traits::md5sum<Service>();
  options.req_datatype = ros::message_traits::datatype<typename Service::Request>();
  options.res_datatype = ros::message_traits::datatype<typename Service::Response>();
  options.helper = boost::make_shared<IntakeOfService<Service>>(std::move(callback), name,
                                                                most_bytes, diagnostics);
  return node.advertiseService(options);
}

/// The only node whose messages on a topic are accepted: the expected node, or else the first with
/// a valid message.
class Peer {
 public:
  void expect(const std::string& node) { node_ = node; }  ///< "": the first sender
  bool may_be(const std::string& node) const { return node_.empty() || node_ == node; }
  void is(const std::string& node) {
    if (node_.empty()) node_ = node;
  }
  const std::string& name() const { return node_; }

 private:
  std::string node_;
};

}  // namespace threelink_sim
