"""Who may use the cloud's gateway: sign-in, passwords, roles, tokens, other pages, and what of it is written down.

Addresses 127.0.76.x, 127.0.77.x.
"""
import itertools

import support
from gateway_case import CLOUD, GOOD, ROBOT, WAIT_S, GatewayCase

FREE, LONG_S = 5, 4  # guesses without a wait; a wait that is not over before a busy machine's next word
MOST_TRIED = 3  # what a stalled machine adds comes and goes


class Users(GatewayCase):
    block, udp_port = 76, 50076

    # ---- sign-in

    def test_the_cookie_is_for_this_page_alone(self):
        for trait in ("Secure", "HttpOnly", "SameSite=Strict", "Path=/"):
            self.assertIn(trait, self.admin.set_cookie)
        self.assertTrue(self.admin.set_cookie.startswith("__Host-"))
        self.assertEqual(self.admin.ask("GET", "/api/v1/me").json["role"], "admin")

    def test_a_sign_in_gives_a_new_session_and_a_sign_out_ends_it(self):
        client = self.client()
        client.cookie = "0" * 64  # one that somebody has planted
        self.assertEqual(client.sign_in("vic", GOOD).status, 201)
        self.assertNotEqual(client.cookie, "0" * 64)
        self.assertEqual(client.ask("DELETE", "/api/v1/session").status, 204)
        self.assert_problem(client.ask("GET", "/api/v1/robots"), 401, "not_signed_in")

    def test_guessing_has_to_wait(self):
        self.admin.ask("POST", "/api/v1/users", {"name": "gus", "role": "viewer", "password": GOOD})
        for free in (FREE, *[0] * MOST_TRIED):  # a wait that was over before the right word came is followed by another one
            self.wait_refused(lambda i: self.client().sign_in("gus", f"wrong {i} wrong wrong"), 401, LONG_S, free)
            refused = self.client().sign_in("gus", GOOD)
            if refused.status == 429:
                break
        self.assert_problem(refused, 429, "wait")
        self.assertGreater(int(refused.headers["Retry-After"]), 0)

    def wait_refused(self, guess, wrong, at_least=0, free=FREE):
        """Guesses as soon as it may, until it has to wait, for so many seconds."""
        tries = itertools.count()

        def has_to_wait():
            i = next(tries)
            answer = guess(i)
            if i < free or answer.status != 429:
                self.assertEqual(answer.status, wrong)
                return False
            return int(answer.headers["Retry-After"] or 0) >= at_least  # what is refused so is no try

        self.fleet.wait("guessing has to wait", has_to_wait, WAIT_S)

    def test_who_gets_a_password_of_an_admin_s_takes_another_one_first_if_the_admin_says_so(self):
        wish = {"name": "mia", "role": "operator", "password": GOOD, "must_change": True}
        self.assertEqual(self.admin.ask("POST", "/api/v1/users", wish).status, 201)
        mia = self.client()
        self.assertTrue(mia.sign_in("mia", GOOD).json["must_change_password"])
        self.assert_problem(mia.ask("GET", "/api/v1/robots"), 403, "password_must_change")
        self.assertEqual(mia.ask("PUT", "/api/v1/me/password", {"old": GOOD, "new": GOOD + " of mia"}).status, 204)
        self.assertFalse(mia.sign_in("mia", GOOD + " of mia").json["must_change_password"])
        again = {"password": GOOD, "must_change": True}
        self.assertEqual(self.admin.ask("PUT", "/api/v1/users/mia/password", again).status, 204)
        self.assertTrue(mia.sign_in("mia", GOOD).json["must_change_password"])

    def test_a_password_of_the_console_s_makes_an_admin_and_that_is_on_record(self):
        self.assertEqual(self.admin.ask("POST", "/api/v1/users", {"name": "otto", "role": "viewer", "password": GOOD}).status, 201)
        self.assertEqual(self.admin.ask("PATCH", "/api/v1/users/otto", {"disabled": True}).status, 200)
        made = self.fleet.json("cloud", "password", self.fleet.dir(CLOUD), "--user", "otto")
        self.assertEqual(self.client().sign_in("otto", made["password"]).json["role"], "admin")
        records = self.admin.ask("GET", "/api/v1/audit?limit=50").json["records"]
        told = [(one["who"], one["action"], one["about"], one["outcome"]) for one in records if one["who"] == "console"]
        self.assertEqual(self.admin.ask("DELETE", "/api/v1/users/otto").status, 204)
        self.assertEqual(told[0], ("console", "trb cloud password", "otto: new password, admin (was viewer), enabled", "done"))

    def test_an_unknown_user_is_refused_as_a_wrong_password_is(self):
        wrong, unknown = self.client().sign_in("olga", "wrong wrong wrong"), self.client().sign_in("nobody", "wrong wrong wrong")
        self.assertEqual((wrong.status, wrong.bytes), (unknown.status, unknown.bytes))

    def test_a_new_password_ends_the_sessions(self):
        self.admin.ask("POST", "/api/v1/users", {"name": "pia", "role": "viewer", "password": GOOD})
        one, two = self.client(), self.client()
        one.sign_in("pia", GOOD)
        two.sign_in("pia", GOOD)
        self.assert_problem(one.ask("PUT", "/api/v1/me/password", {"old": "wrong wrong wrong", "new": GOOD + "!"}), 403)
        weak = one.ask("PUT", "/api/v1/me/password", {"old": GOOD, "new": "short"})
        self.assert_problem(weak, 422)
        self.assertEqual(weak.json["errors"][0]["pointer"], "/new")
        self.assertEqual(one.ask("PUT", "/api/v1/me/password", {"old": GOOD, "new": GOOD + "!"}).status, 204)
        self.assertEqual(two.ask("GET", "/api/v1/me").status, 401)
        self.assertEqual(two.sign_in("pia", GOOD).status, 401)
        self.assertEqual(two.sign_in("pia", GOOD + "!").status, 201)

    def keep_hashing(self, *clients):
        """The gateway's two threads have to hash these passwords before anything that is sent from now on; connections of these
        clients, made before: a handshake may take as long as a hash. They are the last ones: who says nothing for 10 s is cut."""
        hashing = [self.connected(self.admin) for _ in range(16)]
        out = [self.connected(client) for client in clients]
        for connection in hashing:
            self.admin.begin("PUT", "/api/v1/users/vic/password", {"password": GOOD}, connection)
        self.addCleanup(lambda: self.viewer.sign_in("vic", GOOD))
        return out

    def connected(self, client):
        connection = client.connect()
        self.addCleanup(connection.close)
        return connection

    def eva(self, role):
        """A user for one test, signed in."""
        self.admin.ask("POST", "/api/v1/users", {"name": "eva", "role": role, "password": GOOD})
        self.addCleanup(self.admin.ask, "DELETE", "/api/v1/users/eva")
        client = self.client()
        client.sign_in("eva", GOOD)
        return client

    def test_who_has_taken_over_a_session_does_not_undo_the_admins_reset(self):
        new = GOOD + " by the admin"
        for _ in range(MOST_TRIED):  # if all was hashed before the admin's word came, the session was the thief's still
            thief = self.eva("operator")
            of_thief, of_admin = self.keep_hashing(thief, self.admin)
            thief.begin("PUT", "/api/v1/me/password", {"old": GOOD, "new": GOOD + " by the thief"}, of_thief)
            self.admin.begin("PUT", "/api/v1/users/eva/password", {"password": new}, of_admin)
            self.assertEqual(of_admin.getresponse().status, 204)
            status = of_thief.getresponse().status
            self.assertEqual(self.client().sign_in("eva", new).status, 201)  # whoever came first, the admin's counts
            if status == 401:
                break
            self.doCleanups()
        self.assertEqual(status, 401)

    def test_an_admin_who_is_disabled_adds_nobody_with_what_he_has_sent_before(self):
        for _ in range(MOST_TRIED):  # if all was hashed before she is disabled, she was an admin still
            eva = self.eva("admin")
            of_eva, of_admin = self.keep_hashing(eva, self.admin)
            eva.begin("POST", "/api/v1/users", {"name": "door", "role": "admin", "password": GOOD}, of_eva)
            self.admin.begin("PATCH", "/api/v1/users/eva", {"disabled": True}, of_admin)
            self.assertEqual(of_admin.getresponse().status, 200)
            status = of_eva.getresponse().status
            if status == 401:
                break
            self.doCleanups()
            self.admin.ask("DELETE", "/api/v1/users/door")
        self.assertEqual(status, 401)
        self.assert_problem(self.admin.ask("GET", "/api/v1/users/door"), 404)

    def test_a_session_that_was_taken_over_does_not_tell_the_password(self):
        self.admin.ask("POST", "/api/v1/users", {"name": "max", "role": "viewer", "password": GOOD})
        client = self.client()
        client.sign_in("max", GOOD)
        wrong = {"old": "wrong wrong wrong", "new": GOOD + "!"}
        self.wait_refused(lambda _: client.ask("PUT", "/api/v1/me/password", wrong), 403, 1)

    def test_the_last_admin_stays(self):
        self.assert_problem(self.admin.ask("DELETE", "/api/v1/users/admin"), 409)
        self.assert_problem(self.admin.ask("PATCH", "/api/v1/users/admin", {"role": "viewer"}), 409)

    # ---- rights

    def test_nobody_without_a_session(self):
        stranger = self.client()
        for path in ("/api/v1/robots", "/api/v1/users", "/metrics", "/api/v1/audit"):
            self.assert_problem(stranger.ask("GET", path), 401, "not_signed_in")
        self.assertEqual(stranger.live().status, 401)
        self.assertEqual(stranger.ask("GET", "/api/v1/health").status, 200)

    def test_each_role_has_its_own(self):
        self.assert_problem(self.viewer.ask("POST", f"/api/v1/robots/{ROBOT}/stop"), 403, "role_too_low")
        self.assert_problem(self.operator.ask("GET", "/api/v1/users"), 403, "role_too_low")
        self.assertEqual(self.viewer.ask("GET", "/api/v1/robots").status, 200)

    def test_another_page_changes_nothing(self):
        stop = f"/api/v1/robots/{ROBOT}/stop"
        self.assert_problem(self.operator.ask("POST", stop, Origin="https://evil.example"), 403, "wrong_origin")
        self.assert_problem(self.operator.ask("POST", stop, X_CSRF_Token=None), 403, "wrong_csrf")
        self.assert_problem(self.operator.ask("POST", stop, X_CSRF_Token="0" * 64), 403, "wrong_csrf")
        self.assert_problem(self.operator.ask("POST", stop, Host="evil.example"), 403, "wrong_host")
        self.assertEqual(self.operator.live(Origin="https://evil.example").status, 403)

    def test_a_token(self):
        made = self.admin.ask("POST", "/api/v1/tokens", {"name": "exporter", "role": "operator", "read_only": True, "days": 1})
        self.assertEqual(made.status, 201)
        program = self.client(made.json["secret"])
        self.secrets.append(made.json["secret"])
        self.assertIn("trb_gateway_rows{kind=\"robot\"} 1", program.ask("GET", "/metrics").bytes.decode())
        self.assert_problem(program.ask("POST", "/api/v1/stop"), 403, "read_only_token")
        self.assertNotIn("secret", self.admin.ask("GET", "/api/v1/tokens").json["tokens"][0])
        self.assertEqual(self.admin.ask("DELETE", "/api/v1/tokens/exporter").status, 204)
        self.assertEqual(program.ask("GET", "/metrics").status, 401)

    def said(self, *begin):
        """What is on record of them, the newest last: of a route, what about and how it ended."""
        return [(one["about"], one["outcome"]) for one in reversed(self.admin.ask("GET", "/api/v1/audit?limit=100").json["records"])
                if one["who"] == "admin" and one["action"].startswith(begin) and one["about"].startswith("nia")]

    def test_the_audit_log_says_which_rights_were_given_and_no_secret(self):
        self.admin.ask("POST", "/api/v1/users", {"name": "nia", "role": "viewer", "password": "short"})
        self.admin.ask("POST", "/api/v1/users", {"name": "nia", "role": "viewer", "password": GOOD})
        self.admin.ask("PATCH", "/api/v1/users/nia", {"role": "admin"})
        self.admin.ask("PATCH", "/api/v1/users/nia", {"role": "operator", "disabled": True})
        self.admin.ask("PATCH", "/api/v1/users/nia", {"disabled": False})
        self.admin.ask("PATCH", "/api/v1/users/nia", {"role": "queen"})
        self.admin.ask("PUT", "/api/v1/users/nia/password", {"password": GOOD + " two"})
        self.assertEqual(self.said("POST /api/v1/users", "PATCH /api/v1/users", "PUT /api/v1/users"), [
            ("nia viewer", "refused: 422"), ("nia viewer", "done"), ("nia admin", "done"), ("nia operator disabled", "done"),
            ("nia enabled", "done"), ("nia", "refused: 422"), ("nia", "done")])
        for wish in ({"role": "viewer", "read_only": True}, {"role": "operator"}):
            made = self.admin.ask("POST", "/api/v1/tokens", {"name": "nia-" + wish["role"], "days": 1} | wish)
            self.secrets.append(made.json["secret"])
        self.assertEqual(self.said("POST /api/v1/tokens"),
                         [("nia-viewer viewer read_only", "done"), ("nia-operator operator", "done")])
        log = self.admin.ask("GET", "/api/v1/audit/export").bytes.decode()
        for secret in self.secrets + [GOOD]:
            self.assertNotIn(secret, log)

    def test_who_is_signed_out_sees_nothing_more(self):
        client = self.client()
        client.sign_in("vic", GOOD)
        live = client.live()
        self.addCleanup(live.close)
        live.say({"subscribe": "fleet"})
        client.ask("DELETE", "/api/v1/session")
        self.assertEqual(live.until(lambda heard: "closed" in heard)["closed"], 4401)

    def test_no_secret_is_written_anywhere(self):
        self.secrets += [GOOD, self.admin.cookie, self.operator.cookie, self.admin.csrf]
        for path in self.fleet.dir(CLOUD).rglob("*"):
            if path.is_file():
                kept = path.read_bytes()
                for secret in self.secrets:
                    self.assertNotIn(secret.encode(), kept, path)
        self.assertEqual((self.fleet.dir(CLOUD) / "keys/gateway.key").stat().st_mode & 0o777, 0o600)
        self.assertEqual((self.fleet.dir(CLOUD) / "state/gateway.db").stat().st_mode & 0o777, 0o600)


if __name__ == "__main__":
    support.main()
