/** Who is signed in. The browser keeps the cookie, which no script can read, and that there was a sign-in. */
import { api, Problem } from './api/client';
import type { Role, Session } from './api/types';
import { t } from './i18n/i18n.svelte';
import { live } from './live/live.svelte';

const KEPT = 'trb.signedIn';
const ROLES: Role[] = ['viewer', 'operator', 'admin'];

/** `unsafe`: signed in with a password that somebody else made; only a new one opens the rest. */
export type SignInState = 'asking' | 'out' | 'ended' | 'unsafe' | 'in';

class SessionStore {
  state = $state<SignInState>('asking');
  user = $state('');
  role = $state<Role>('viewer');
  /** The gateway could not be asked whether there is a session. */
  isUnreachable = $state(false);

  constructor() {
    api.sayOf = (silence, seconds) => t(`common.${silence}`, { seconds });
    api.onSignedOut = (isTaken) => {
      this.end('ended');
      if (isTaken) localStorage.setItem(KEPT, '1'); // of the browser, not of this tab
    };
  }

  may(least: Role): boolean {
    return ROLES.indexOf(this.role) >= ROLES.indexOf(least);
  }

  /** The session of the cookie, if there is one. */
  async find(): Promise<void> {
    if (localStorage.getItem(KEPT) === null) return this.end('out'); // a question would be refused, and logged as a fault
    try {
      this.begin(await api.get<Session>('/api/v1/session'));
    } catch (problem) {
      this.isUnreachable = problem instanceof Problem && problem.isUnreachable;
      this.state = 'out';
    }
  }

  async signIn(user: string, password: string): Promise<void> {
    this.begin(await api.post<Session>('/api/v1/session', { body: { user, password } }));
  }

  /** The sessions end with the old password; this one is followed by a new one. */
  async changePassword(old: string, fresh: string): Promise<void> {
    const user = this.user;
    await api.send('PUT', '/api/v1/me/password', { body: { old, new: fresh } });
    await this.signIn(user, fresh);
  }

  async signOut(): Promise<void> {
    await this.leave('/api/v1/session');
  }

  async signOutEverywhere(): Promise<void> {
    await this.leave('/api/v1/me/sessions');
  }

  private async leave(path: string): Promise<void> {
    await api.send('DELETE', path);
    api.csrf = api.user = '';
    this.end('out');
  }

  private begin(session: Session): void {
    api.csrf = session.csrf;
    api.user = session.user;
    this.user = session.user;
    this.role = session.role;
    this.isUnreachable = false;
    localStorage.setItem(KEPT, '1');
    this.state = session.must_change_password ? 'unsafe' : 'in';
    if (this.state === 'in') live.start();
  }

  private end(state: SignInState): void {
    live.stop();
    localStorage.removeItem(KEPT);
    this.state = state;
    this.user = '';
  }
}

export const session = new SessionStore();
