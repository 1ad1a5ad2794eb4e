#include "hydrapod/studio/server.hpp"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <sys/random.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <exception>
#include <limits>
#include <list>
#include <optional>

#include "hydrapod/base/error.hpp"
#include "hydrapod/report/json.hpp"

namespace hydrapod::studio {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using Failure = beast::error_code;
using std::chrono::seconds;

/// For every answer. The page's own policy stands in the page; this one holds for all of them.
template <class Fields>
void protect(Fields& fields) {
  fields.set(http::field::cache_control, "no-store");
  fields.set("X-Content-Type-Options", "nosniff");
  fields.set(http::field::x_frame_options, "DENY");
  fields.set("Referrer-Policy", "no-referrer");
  fields.set("Cross-Origin-Resource-Policy", "same-origin");
  fields.set("Cross-Origin-Opener-Policy", "same-origin");
  fields.set("Content-Security-Policy", "frame-ancestors 'none'");
}

Response refusal(unsigned status, const std::string& message) {
  // a message may quote a text that is no UTF-8
  const report::Json json{{"error", message}};
  return {status, json.dump(-1, ' ', false, report::Json::error_handler_t::replace)};
}

std::string text_of(boost::string_view text) { return {text.data(), text.size()}; }

}  // namespace

std::string random_key() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw base::ComputationError(
        fmt::format("the system gave no random numbers: {}", std::strerror(errno)));
  std::string key;
  for (const auto byte : bytes) key += fmt::format("{:02x}", byte);
  return key;
}

bool is_own_host(const std::string& host, std::uint16_t port, bool loopback) {
  const std::string end = fmt::format(":{}", port);
  if (!host.ends_with(end)) return false;
  std::string name = host.substr(0, host.size() - end.size());
  if (name == "localhost") return true;
  const bool brackets = name.starts_with('[') && name.ends_with(']');
  if (brackets) name = name.substr(1, name.size() - 2);
  Failure failure;
  const auto address = asio::ip::make_address(name, failure);
  if (failure || address.is_v6() != brackets) return false;
  return !loopback || address.is_loopback();
}

// ---- what connections share ---------------------------------------------------------------------

namespace {
class Connection;
class Listener;

struct Shared {
  ServerOptions options;
  Site& site;
  std::uint16_t port{};
  bool loopback{true};
  bool stopping{};
  std::list<std::weak_ptr<Connection>> connections{};  ///< in the order of their beginning
  std::list<std::weak_ptr<Listener>> listeners{};
};

template <class Kind>
std::size_t living(std::list<std::weak_ptr<Kind>>& list) {
  list.remove_if([](const auto& one) { return one.expired(); });
  return list.size();
}

// ---- a page that listens ------------------------------------------------------------------------

class Listener : public std::enable_shared_from_this<Listener> {
 public:
  Listener(beast::tcp_stream&& stream, std::shared_ptr<Shared> shared)
      : stream_(std::move(stream)), shared_(std::move(shared)) {}

  template <class Head>
  void begin(const Head& head) {
    stream_.next_layer().expires_never();  // the WebSocket has its own times
    stream_.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
    stream_.set_option(websocket::stream_base::decorator(
        [](websocket::response_type& response) { protect(response); }));
    stream_.read_message_max(4096);
    stream_.async_accept(head, [self = shared_from_this()](Failure failure) {
      if (failure) return;
      self->open_ = true;
      self->tell(std::make_shared<const std::string>(self->shared_->site.greeting()));
      self->read();
    });
  }

  void tell(const std::shared_ptr<const std::string>& text) {
    if (!open_) return;
    waiting_ += text->size();
    if (waiting_ > shared_->options.limits.waiting) return close();
    queue_.push_back(text);
    if (queue_.size() == 1) write();
  }

  void close() {
    open_ = false;
    beast::get_lowest_layer(stream_).close();
  }

 private:
  void write() {
    stream_.text(true);
    stream_.async_write(asio::buffer(*queue_.front()),
                        [self = shared_from_this()](Failure failure, std::size_t) {
                          if (failure) return self->close();
                          self->waiting_ -= self->queue_.front()->size();
                          self->queue_.pop_front();
                          if (!self->queue_.empty()) self->write();
                        });
  }

  /// Pages send nothing; but only who reads sees that a page has gone, and answers its pings.
  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](Failure failure, std::size_t) {
      if (failure) return self->close();
      self->buffer_.clear();
      self->read();
    });
  }

  websocket::stream<beast::tcp_stream> stream_;
  std::shared_ptr<Shared> shared_;
  beast::flat_buffer buffer_;
  std::deque<std::shared_ptr<const std::string>> queue_;
  std::size_t waiting_{};
  bool open_{};
};

// ---- a connection -------------------------------------------------------------------------------

class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket&& socket, std::shared_ptr<Shared> shared)
      : stream_(std::move(socket)), shared_(std::move(shared)) {}

  void read_head() {
    const auto& limits = shared_->options.limits;
    head_.emplace();
    head_->header_limit(static_cast<std::uint32_t>(limits.header));
    // judged when the header is there; Boost 1.74 takes "none" for 0
    head_->body_limit(std::numeric_limits<std::uint64_t>::max());
    stream_.expires_after(seconds(trusted_ ? limits.idle_seconds : limits.header_seconds));
    idle_ = true;
    http::async_read_header(
        stream_, buffer_, *head_,
        [self = shared_from_this()](Failure failure, std::size_t) { self->on_head(failure); });
  }

  void close() { stream_.close(); }
  [[nodiscard]] bool trusted() const { return trusted_; }
  [[nodiscard]] bool idle() const { return idle_; }

 private:
  void on_head(Failure failure) {
    idle_ = false;
    if (failure == http::error::header_limit || failure == http::error::buffer_overflow)
      return refuse({431, "header too large"});
    if (failure && failure.category() == make_error_code(http::error::bad_method).category() &&
        failure != http::error::end_of_stream && failure != http::error::partial_message)
      return refuse({400, "not understood"});
    if (failure) return close();
    const auto objection = judge();
    if (objection) return refuse(*objection);
    trusted_ = true;
    if (websocket::is_upgrade(head_->get())) return listen();
    read_body();
  }

  /// Nothing that a stranger could use: the same few words for everybody.
  std::optional<std::pair<unsigned, const char*>> judge() {
    const auto& fields = head_->get();
    head_only_ = fields.method() == http::verb::head;
    if (fields.count(http::field::host) != 1) return {{400, "one Host is expected"}};
    const std::string host = text_of(fields[http::field::host]);
    if (!is_own_host(host, shared_->port, shared_->loopback))
      return {{403, "this host is not served"}};
    for (const auto& field : fields)
      if (field.name() == http::field::origin && text_of(field.value()) != "http://" + host)
        return {{403, "this origin is not served"}};
    if (!take_target(text_of(fields.target()))) return {{404, "not found"}};
    // another page may lead to this one (open.html does), and learns nothing from it
    const auto site = fields["Sec-Fetch-Site"];
    const bool leads_here = request_.path.empty() && fields["Sec-Fetch-Mode"] == "navigate" &&
                            fields["Sec-Fetch-Dest"] == "document";
    if (!site.empty() && site != "same-origin" && site != "none" && !leads_here)
      return {{403, "this origin is not served"}};
    if (fields.method() != http::verb::get && fields.method() != http::verb::post)
      return {{405, "GET and POST are served"}};
    request_.posts = fields.method() == http::verb::post;
    const auto type = fields[http::field::content_type];
    if (request_.posts && type != "application/json" && type != "application/octet-stream")
      return {{415, "expected application/json or application/octet-stream"}};
    return {};
  }

  /// "/KEY/path?query"
  bool take_target(const std::string& target) {
    const std::string& key = shared_->options.key;
    if (target.size() < key.size() + 2 || target[0] != '/' || target[key.size() + 1] != '/' ||
        CRYPTO_memcmp(target.data() + 1, key.data(), key.size()) != 0)
      return false;
    const std::string rest = target.substr(key.size() + 2);
    const auto mark = rest.find('?');
    request_ = {.path = rest.substr(0, mark),
                .query = mark == rest.npos ? "" : rest.substr(mark + 1)};
    return true;
  }

  void listen() {
    if (request_.path != "events" || request_.posts) return refuse({404, "not found"});
    if (living(shared_->listeners) >= shared_->options.limits.listeners)
      return refuse({503, "too many pages listen"});
    const auto head = head_->release();
    const auto listener = std::make_shared<Listener>(std::move(stream_), shared_);
    shared_->listeners.push_back(listener);
    listener->begin(head);
  }

  void read_body() {
    const auto& limits = shared_->options.limits;
    auto place = shared_->site.upload_place(request_);
    if (const auto* refused = std::get_if<Response>(&place)) return answer(*refused, false);
    const auto& path = std::get<std::string>(place);
    const auto length = head_->content_length();
    const std::uint64_t most = path.empty() ? limits.body : limits.upload;
    if (length && *length > most) {
      if (!path.empty()) shared_->site.upload_failed(path);
      return answer(too_large(most), false);
    }
    path.empty() ? read_text() : read_file(path);
  }

  static Response too_large(std::uint64_t most) {
    return refusal(413, fmt::format("larger than {} MiB, which is the most that is taken",
                                    most >> 20U));
  }

  void read_text() {
    const auto& limits = shared_->options.limits;
    text_.emplace(std::move(*head_));
    text_->body_limit(limits.body);
    stream_.expires_after(seconds(limits.body_seconds));
    http::async_read(stream_, buffer_, *text_,
                     [self = shared_from_this()](Failure failure, std::size_t) {
                       self->on_text(failure);
                     });
  }

  void on_text(Failure failure) {
    if (failure == http::error::body_limit)
      return answer(too_large(shared_->options.limits.body), false);
    if (failure) return close();
    request_.body = std::move(text_->get().body());
    keeps_ = text_->get().keep_alive();
    answer(answered([&] { return shared_->site.answer(request_); }), keeps_);
  }

  void read_file(const std::string& path) {
    const auto& limits = shared_->options.limits;
    file_.emplace(std::move(*head_));
    file_->body_limit(limits.upload);
    Failure failure;
    file_->get().body().open(path.c_str(), beast::file_mode::write, failure);
    if (failure) {
      shared_->site.upload_failed(path);
      return answer(refusal(500, "the record cannot be kept: " + failure.message()), false);
    }
    stream_.expires_after(seconds(limits.upload_seconds));
    http::async_read(stream_, buffer_, *file_,
                     [self = shared_from_this(), path](Failure wrong, std::size_t) {
                       self->on_file(wrong, path);
                     });
  }

  void on_file(Failure failure, const std::string& path) {
    file_->get().body().close();
    keeps_ = file_->get().keep_alive();
    if (failure) {
      shared_->site.upload_failed(path);
      if (failure == http::error::body_limit)
        return answer(too_large(shared_->options.limits.upload), false);
      if (failure.category() == boost::system::system_category() && failure != asio::error::eof)
        return answer(refusal(500, "the record cannot be kept: " + failure.message()), false);
      return close();
    }
    answer(answered([&] { return shared_->site.uploaded(request_, path); }), keeps_);
  }

  template <class Make>
  Response answered(const Make& make) {
    try {
      return make();
    } catch (const base::InputError& error) {
      std::string text;
      for (const auto& one : error.diagnostics()) text += (text.empty() ? "" : "\n") + one.text();
      return refusal(422, text);
    } catch (const std::exception& error) {
      return refusal(500, error.what());
    }
  }

  void refuse(std::pair<unsigned, const char*> why) { answer(refusal(why.first, why.second), false); }

  void answer(Response response, bool keeps) {
    response_ = {};
    response_.result(response.status);
    response_.version(11);
    protect(response_);
    response_.set(http::field::content_type, response.type);
    response_.keep_alive(keeps);
    if (!head_only_) response_.body() = std::move(response.body);
    response_.prepare_payload();
    stream_.expires_after(seconds(shared_->options.limits.write_seconds));
    http::async_write(stream_, response_,
                      [self = shared_from_this(), keeps](Failure failure, std::size_t) {
                        if (failure) return self->close();
                        keeps && !self->shared_->stopping ? self->read_head() : self->end();
                      });
  }

  /// What is still on its way is read and dropped, else the answer could be lost with it.
  void end() {
    idle_ = true;
    Failure ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    stream_.expires_after(seconds(2));
    drop(std::size_t{4} << 20U);
  }

  void drop(std::size_t most) {
    buffer_.clear();
    stream_.async_read_some(
        buffer_.prepare(16384), [self = shared_from_this(), most](Failure failure, std::size_t n) {
          if (failure || n >= most) return self->close();
          self->drop(most - n);
        });
  }

  beast::tcp_stream stream_;
  std::shared_ptr<Shared> shared_;
  beast::flat_buffer buffer_{std::size_t{64} << 10U};
  std::optional<http::request_parser<http::empty_body>> head_;
  std::optional<http::request_parser<http::string_body>> text_;
  std::optional<http::request_parser<http::file_body>> file_;
  http::response<http::string_body> response_;
  Request request_;
  bool trusted_{}, idle_{}, keeps_{};
  bool head_only_{};  ///< an answer to HEAD has no body
};

}  // namespace

// ---- the server ---------------------------------------------------------------------------------

class Server::Parts : public std::enable_shared_from_this<Parts> {
 public:
  Parts(asio::io_context& context, ServerOptions options, Site& site)
      : shared(std::make_shared<Shared>(Shared{std::move(options), site})),
        context_(context),
        acceptor_(context),
        again_(context) {
    const auto& asked = shared->options;
    try {
      const tcp::endpoint place(asio::ip::make_address(asked.address), asked.port);
      acceptor_.open(place.protocol());
      acceptor_.set_option(asio::socket_base::reuse_address(true));
      acceptor_.bind(place);
      acceptor_.listen(asio::socket_base::max_listen_connections);
    } catch (const boost::system::system_error& error) {
      base::refuse(fmt::format("{}, port {}", asked.address, asked.port),
                   "cannot listen there: " + error.code().message());
    }
    shared->port = acceptor_.local_endpoint().port();
    shared->loopback = acceptor_.local_endpoint().address().is_loopback();
  }

  void accept() {
    acceptor_.async_accept(context_, [self = shared_from_this()](Failure failure,
                                                                 tcp::socket socket) {
      if (self->shared->stopping) return;
      if (failure) return self->accept_later();
      self->take(std::move(socket));
      self->accept();
    });
  }

  void stop() {
    shared->stopping = true;
    Failure ignored;
    acceptor_.close(ignored);
    again_.cancel();
    for (const auto& one : shared->connections)
      if (const auto connection = one.lock()) connection->close();
    for (const auto& one : shared->listeners)
      if (const auto listener = one.lock()) listener->close();
  }

  std::shared_ptr<Shared> shared;

 private:
  /// No file descriptor is free, for instance.
  void accept_later() {
    again_.expires_after(std::chrono::milliseconds(100));
    again_.async_wait([self = shared_from_this()](Failure failure) {
      if (!failure && !self->shared->stopping) self->accept();
    });
  }

  void take(tcp::socket socket) {
    auto& all = shared->connections;
    if (living(all) >= shared->options.limits.connections && !make_room()) return;
    const auto connection = std::make_shared<Connection>(std::move(socket), shared);
    all.push_back(connection);
    connection->read_head();
  }

  /// The oldest without the key goes, else the oldest that waits for its next request.
  bool make_room() {
    for (const bool trusted : {false, true})
      for (auto one = shared->connections.begin(); one != shared->connections.end(); ++one) {
        const auto connection = one->lock();
        if (!connection || connection->trusted() != trusted || !connection->idle()) continue;
        connection->close();
        shared->connections.erase(one);
        return true;
      }
    return false;
  }

  asio::io_context& context_;
  tcp::acceptor acceptor_;
  asio::steady_timer again_;
};

Server::Server(asio::io_context& context, ServerOptions options, Site& site)
    : parts_(std::make_shared<Parts>(context, std::move(options), site)) {
  parts_->accept();
}

Server::~Server() { parts_->stop(); }

std::uint16_t Server::port() const { return parts_->shared->port; }

void Server::tell(const std::string& text) {
  auto& listeners = parts_->shared->listeners;
  living(listeners);
  const auto shared_text = std::make_shared<const std::string>(text);
  for (const auto& one : listeners)
    if (const auto listener = one.lock()) listener->tell(shared_text);
}

void Server::stop() { parts_->stop(); }

}  // namespace hydrapod::studio
