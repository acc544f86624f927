/** A tone and a notification of the browser for each alarm that is new or gets worse, in every view. Both are off until somebody wants them. */
import type { Alert, AlertRow } from '../api/types';
import { alertText } from '../fleet/alert_text';
import { t, tOr } from '../i18n/i18n.svelte';
import { hrefOf } from '../router.svelte';
import { loudest, NewAlarms, tonesOf } from './new_alarms';

const KEPT_SOUND = 'trb.alarmSound';
const KEPT_NOTICE = 'trb.alarmNotice';
const TONE_S = 0.18;
const PAUSE_S = 0.06;

type Permission = NotificationPermission | 'unsupported';

class Notice {
  isSound = $state(localStorage.getItem(KEPT_SOUND) === 'on');
  isNotice = $state(localStorage.getItem(KEPT_NOTICE) === 'on');
  permission = $state<Permission>('Notification' in window ? Notification.permission : 'unsupported');
  /** A browser plays nothing before somebody has pressed something. */
  isSilent = $state(true);
  private readonly news = new NewAlarms();
  private audio: AudioContext | null = null;

  constructor() {
    const wake = () => void this.wake();
    addEventListener('pointerdown', wake);
    addEventListener('keydown', wake);
  }

  chooseSound(isOn: boolean): void {
    this.isSound = isOn;
    localStorage.setItem(KEPT_SOUND, isOn ? 'on' : 'off');
    if (isOn) void this.wake().then(() => this.play(tonesOf('CRITICAL')));
  }

  /** Asks the browser, which asks the person. To be called by a button alone. */
  async chooseNotice(isOn: boolean): Promise<void> {
    if (isOn && this.permission === 'default') this.permission = await Notification.requestPermission();
    this.isNotice = isOn && this.permission === 'granted';
    localStorage.setItem(KEPT_NOTICE, this.isNotice ? 'on' : 'off');
  }

  see(open: AlertRow[], isKnown: boolean): void {
    const told = this.news.see(open, isKnown);
    const severity = loudest(told);
    if (severity !== null && this.isSound) this.play(tonesOf(severity));
    if (this.isNotice) for (const alert of told.slice(0, 3)) this.show(alert);
  }

  private async wake(): Promise<void> {
    if (!this.isSound || !this.isSilent) return;
    this.audio ??= new AudioContext();
    await this.audio.resume();
    this.isSilent = this.audio.state !== 'running';
  }

  private play(tones: number[]): void {
    const audio = this.audio;
    if (audio === null || audio.state !== 'running') return;
    tones.forEach((tone, i) => {
      const at = audio.currentTime + i * (TONE_S + PAUSE_S);
      const loud = new GainNode(audio, { gain: 0 });
      // Without ramps a tone begins and ends with a crack.
      loud.gain.setValueAtTime(0, at);
      loud.gain.linearRampToValueAtTime(0.4, at + 0.01);
      loud.gain.setValueAtTime(0.4, at + TONE_S - 0.02);
      loud.gain.linearRampToValueAtTime(0, at + TONE_S);
      const voice = new OscillatorNode(audio, { type: 'triangle', frequency: tone });
      voice.connect(loud).connect(audio.destination);
      voice.start(at);
      voice.stop(at + TONE_S);
    });
  }

  private show(alert: Alert): void {
    try {
      const what = alertText(alert);
      // Of an alarm that got worse it takes the place of the one before, and calls again.
      const how = { body: what, tag: alert.id, renotify: true };
      const note = new Notification(`${tOr('severity', alert.severity)}: ${alert.robot}`, how);
      note.onclick = () => {
        window.focus();
        location.hash = hrefOf('alerts', alert.id);
        note.close();
      };
    } catch {
      this.permission = 'unsupported'; // some phones have notifications for installed pages alone
      this.isNotice = false;
    }
  }

  /** Why there is no notification. */
  get why(): string {
    if (this.permission === 'unsupported') return t('notice.unsupported');
    return this.permission === 'denied' ? t('notice.denied') : '';
  }
}

export const notice = new Notice();
