import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vitest/config';

// TRB_GATEWAY: the gateway that `npm run dev` shows. Its certificate is its own.
const gateway = process.env.TRB_GATEWAY ?? 'https://localhost:8443';
const proxy = { target: gateway, changeOrigin: true, secure: false, headers: { Origin: gateway } };
// TRB_POLICY: what the gateway says of its own pages; with it `vite preview` holds a page to the same.
const policy = process.env.TRB_POLICY;
const headers = policy === undefined ? {} : { 'Content-Security-Policy': policy };
// TRB_JUDGE: a proxy before the gateway that holds every answer against its description. It speaks no WebSocket.
const judged = { ...proxy, target: process.env.TRB_JUDGE ?? gateway };
const proxies = { '/api/v1/live': { ...proxy, ws: true }, '/api': judged, '/metrics': proxy };

export default defineConfig({
  plugins: [svelte()],
  base: '/',
  build: {
    target: 'es2022',
    assetsInlineLimit: 0, // the policy of the gateway allows no data: addresses
    modulePreload: { polyfill: false },
    reportCompressedSize: true,
  },
  server: { proxy: proxies },
  preview: { proxy: proxies, headers },
  test: { include: ['src/**/*.test.ts'] },
});
